"""Pictures: what is in them, and what happens where there is nothing to draw or nowhere to write."""

import math
import sys
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.figure import Figure

import kickdrift as kd
from kickdrift import plots
from kickdrift.core.errors import ArgumentError, FileFormatError, KickdriftError, MissingExtraError


def interpreted(system):
    return replace(system, native=False)


def solved(system, end=2.0, step=0.02, **options):
    return kd.solve(interpreted(system), (0.0, end), step=step, **options)


def titles(figure):
    return [axes.get_title("left") for axes in figure.axes]


def texts(axes):
    return [text.get_text() for text in axes.texts]


@pytest.fixture(scope="module")
def pendulum():
    return solved(kd.systems.pendulum())


def test_a_coordinate_over_time_and_its_energy_error(pendulum, tmp_path):
    figure = pendulum.plot(tmp_path / "pendulum.png")
    assert (tmp_path / "pendulum.png").read_bytes().startswith(b"\x89PNG")
    trajectory, phases, energy = figure.axes
    assert figure.get_suptitle() == "pendulum by semi-implicit-euler: 100 steps of 0.02"
    assert titles(figure) == ["trajectory", "phase portrait", "energy error"]
    assert np.array_equal(phases.lines[0].get_xydata(), np.column_stack([pendulum.x, pendulum.v]))
    assert trajectory.get_ylabel() == "x (rad)"
    assert np.array_equal(trajectory.lines[0].get_ydata(), pendulum.x)
    assert np.array_equal(energy.lines[0].get_ydata(), kd.analysis.energy_error(pendulum))
    assert f"largest {kd.analysis.largest_energy_error(pendulum):.2g}" in energy.get_title("right").replace(
        "\N{MINUS SIGN}", "-"
    )


def test_an_orbit_is_drawn_to_scale():
    figure = solved(kd.systems.kepler(0.6)).plot()
    assert titles(figure) == ["trajectory", "energy error"]
    assert figure.axes[0].get_aspect() == 1
    assert (figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()) == ("x", "y")


def test_the_solar_system_has_a_panel_for_the_inner_planets():
    figure = solved(kd.systems.solar_system(), end=20.0, step=1.0, method="velocity-verlet").plot()
    inner, outer, energy = figure.axes
    assert titles(figure) == ["inner bodies", "outer bodies", "energy error"]
    # The Earth's neighbour in the sky is in its line.
    assert set(texts(inner)) == {"Sun", "Mercury", "Venus", "Earth, Moon", "Mars"}
    assert set(texts(outer)) == {"Sun", "Jupiter", "Saturn", "Uranus", "Neptune", "Pluto"}
    assert inner.get_xlabel() == "x (au)"
    assert energy.get_xlabel() == "t (day)"


@pytest.mark.parametrize("end", [3000.0, 9000.0, 16000.0, 24000.0, 36525.0, 47200.0, 68800.0])
def test_names_of_bodies_cover_neither_each_other_nor_dots_and_stay_inside_their_panel(end):
    figure = solved(kd.systems.solar_system(), end=end, step=20.0, method="velocity-verlet", save_every=20).plot()
    figure.draw_without_rendering()
    for axes in figure.axes[:2]:
        frame = axes.get_window_extent()
        names = {text.get_text(): text.get_window_extent() for text in axes.texts}
        for name, written in names.items():
            assert frame.x0 <= written.x0 < written.x1 <= frame.x1, name
            assert frame.y0 <= written.y0 < written.y1 <= frame.y1, name
        for one, other in combinations(names, 2):
            assert not names[one].overlaps(names[other]), (one, other)
        ends = [line.get_xydata()[0] for line in axes.lines if line.get_marker() == "o"]
        for dot in axes.transData.transform(ends):
            assert not any(written.contains(*dot) for written in names.values())


def test_bodies_of_like_orbits_share_a_panel():
    figure = solved(kd.systems.benchmarks_game(), end=0.5, step=0.05).plot()
    assert titles(figure) == ["trajectory", "energy error"]
    assert texts(figure.axes[0]) == ["Sun", "Jupiter", "Saturn", "Uranus", "Neptune"]


def test_a_crowd_has_no_names():
    x, v = np.random.default_rng(0).normal(size=(2, 40, 3))
    crowd = kd.systems.nbody(np.ones(40), x, v, softening=1.0)
    assert texts(solved(crowd, end=0.1).plot().axes[0]) == []


@pytest.mark.parametrize(("shape", "lines"), [((4,), 4), ((12,), 12), ((2, 2, 2), 8)])
def test_other_states_are_drawn_number_by_number(shape, lines):
    s = kd.solve(lambda x: -x, (0.0, 1.0), np.ones(shape), np.zeros(shape), step=0.1, compile=False)
    (axes,) = s.plot().axes
    assert len(axes.lines) == lines
    assert (axes.get_legend() is not None) == (lines == 4)


def test_an_orbit_kept_too_rarely_is_drawn_as_dots():
    kepler = kd.systems.kepler(0.6)
    often, rarely = (solved(kepler, end=60.0, step=0.05, save_every=n) for n in (1, 60))
    assert often.plot().axes[0].lines[0].get_linestyle() == "-"
    assert rarely.plot().axes[0].lines[0].get_linestyle() == "None"


@pytest.mark.parametrize("turns", [0.6, 0.9, 1.1, 2.05, 7.1])
def test_an_orbit_that_goes_round_between_its_states_is_drawn_as_dots(turns):
    period = 2 * math.pi
    s = solved(kd.systems.kepler(0.3), end=60 * turns * period, step=turns * period / 200, save_every=200)
    assert s.plot().axes[0].lines[0].get_linestyle() == "None"


def test_an_orbit_kept_rarely_is_filled_up_to_a_curve():
    s = solved(kd.systems.kepler(0.0), end=60.0, step=0.01, save_every=80)
    drawn = s.plot().axes[0].lines[0].get_xydata()
    assert abs(np.linalg.norm(drawn, axis=1) - 1.0).max() < 0.01
    chords = 0.5 * (s.x[1:] + s.x[:-1])
    assert abs(np.linalg.norm(chords, axis=1) - 1.0).max() > 0.05


def test_a_long_run_keeps_its_extremes():
    s = solved(kd.systems.harmonic_oscillator(), end=100.0, step=0.01)
    (band,) = s.plot().axes[2].collections
    drawn = band.get_paths()[0].vertices[:, 1]
    error = kd.analysis.energy_error(s)
    assert (drawn.min(), drawn.max()) == (error.min(), error.max())


def test_a_solution_of_one_time():
    assert len(solved(kd.systems.kepler(), t_eval=[1.0]).plot().axes) == 2


def test_a_body_that_does_not_move():
    still = kd.solve(interpreted(kd.systems.kepler()), (0.0, 1.0), [1.0, 0.0], [0.0, 1.0], step=0.5)
    assert len(replace(still, x=np.ones_like(still.x)).plot().axes) == 2


def test_a_run_that_blew_up(tmp_path):
    s = kd.solve(lambda x: 1e4 * x, (0.0, 200.0), 1.0, 0.0, step=0.1, compile=False)
    assert not s.success
    assert s.x.max() > 1e300
    energy = np.where(s.x < 1e150, np.minimum(s.x, 1e150) ** 2, np.inf)
    ended = replace(s, invariants={"energy": energy})
    ended.plot(tmp_path / "alone.png")
    plots.plot_energy_comparison({"alone": ended}, tmp_path / "compared.png")


def test_pyplot_is_left_alone(pendulum):
    pendulum.plot()
    assert "matplotlib.pyplot" not in sys.modules


# Methods side by side.


def test_methods_are_told_apart(tmp_path):
    names = ("explicit-euler", "implicit-euler", "kick-drift", "velocity-verlet")
    runs = {name: solved(kd.systems.harmonic_oscillator(), end=50.0, step=0.1, method=name) for name in names}
    figure = plots.plot_energy_comparison(runs, tmp_path / "methods.svg")
    assert (tmp_path / "methods.svg").stat().st_size > 10_000
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.get_legend().get_texts()] == list(names)
    assert len({line.get_color() for line in axes.lines if len(line.get_xdata()) == 501}) == 4
    # In fractions of the height: growth at the top, loss at the bottom, and a ripple that shows in the middle.
    drawn = [line for line in axes.lines if len(line.get_xdata()) == 501]
    heights = [axes.transAxes.inverted().transform(axes.transData.transform(line.get_xydata()))[:, 1] for line in drawn]
    assert heights[0][-1] > 0.9
    assert heights[1][-1] < 0.2
    assert 0.2 < np.ptp(heights[2]) < 0.5
    assert 0.01 < np.ptp(heights[3]) < 0.1


def test_nothing_to_compare_is_refused():
    with pytest.raises(ArgumentError, match="solutions is empty"):
        plots.plot_energy_comparison({})


def test_runs_without_an_energy_are_refused():
    s = kd.solve(lambda x: -x, (0.0, 1.0), 1.0, 0.0, step=0.1, compile=False)
    with pytest.raises(KickdriftError, match="has no energy"):
        plots.plot_energy_comparison({"mine": s})


# Stability.


@pytest.mark.parametrize(
    ("name", "area"), [("explicit-euler", np.pi), ("implicit-midpoint", 32), ("implicit-euler", 64 - np.pi)]
)
def test_regions_have_the_area_of_the_exact_ones(name, area):
    (axes,) = plots.plot_stability_region(name).axes
    shaded = axes.collections[0].get_paths()[0]
    assert sum(signed_area(polygon) for polygon in shaded.to_polygons()) == pytest.approx(area, rel=0.02)


def signed_area(polygon):
    x, y = polygon.T
    return 0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])


@pytest.mark.parametrize(("name", "limit"), [("kick-drift", "2"), ("blanes-moan-srkn6b", "3.1635")])
def test_eigenvalues_of_words_split_at_the_limit(name, limit):
    (axes,) = plots.plot_stability_region(name).axes
    assert f"hω = {limit};" in axes.get_title("left")
    small, large, both = (line.get_ydata() for line in axes.lines)
    together = np.isfinite(both)
    assert together.sum() > 100
    assert np.allclose(large[together], 1, atol=1e-6)
    assert (large[~together] > 1).all()
    assert np.allclose(small * large, 1, rtol=1e-6)


# Where it is written.


def test_a_folder_that_is_not_there_is_an_error(pendulum, tmp_path):
    with pytest.raises(ArgumentError, match=r"path=5 is not a path; give a string such as 'picture\.png'"):
        pendulum.plot(5)
    with pytest.raises(FileFormatError, match=r"path='.*missing.p\.png' cannot be written: No such file"):
        pendulum.plot(tmp_path / "missing" / "p.png")


def test_an_ending_that_is_no_picture_is_an_error(pendulum, tmp_path):
    with pytest.raises(FileFormatError, match=r"Format 'mp3' is not supported.*use a name that ends in \.png"):
        pendulum.plot(tmp_path / "p.mp3")


def test_plots_go_into_axes_of_ones_own(pendulum, tmp_path):
    figure = Figure()
    left, right, low, last = figure.subplots(1, 4)
    assert pendulum.plot(ax=left) is figure
    assert titles(figure) == ["trajectory", "", "", ""]
    assert solved(kd.systems.solar_system(), end=20.0, step=1.0).plot(ax=low) is figure
    assert len(texts(low)) > 5  # all bodies in one panel
    plots.plot_energy_comparison({"run": pendulum}, ax=right)
    plots.plot_stability_region("leapfrog", tmp_path / "all.png", ax=last)
    assert right.get_yscale() == "symlog"
    assert len(last.lines) == 3
    assert len(figure.axes) == 4
    assert (tmp_path / "all.png").exists()
    for draw in (pendulum.plot, lambda ax: plots.plot_stability_region("leapfrog", ax=ax)):
        with pytest.raises(ArgumentError, match=r"ax=.* is not a matplotlib Axes"):
            draw(ax=figure)


def test_matplotlib_missing_names_the_extra(pendulum, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'kickdrift\[cli\]'"):
        pendulum.plot()
