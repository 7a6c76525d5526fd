"""Tangent maps, Lyapunov exponents and Poincare sections: exact ones, SciPy's variational equations, and Henon and Heiles."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kickdrift as kd
from kickdrift import analysis, plots
from kickdrift.core.errors import ArgumentError, KickdriftError

OSCILLATOR, PENDULUM, KEPLER = kd.systems.harmonic_oscillator(), kd.systems.pendulum(), kd.systems.kepler()


def henon_heiles(x, out):
    out[0] = -x[0] - 2 * x[0] * x[1]
    out[1] = -x[1] - x[0] * x[0] + x[1] * x[1]


def start(y, energy=0.125):
    return [0.0, y], [math.sqrt(2 * energy - y * y + 2 * y**3 / 3), 0.0]


# The tangent map.


@pytest.mark.parametrize("h", [0.3, -0.3])
def test_tangents_of_linear_maps_are_their_matrices(h):
    kick, drift = np.array([[1, 0], [-h, 1]]), np.array([[1, h], [0, 1]])
    assert np.allclose(analysis.tangent_map(OSCILLATOR, "kick-drift", h), drift @ kick, rtol=0, atol=1e-13)
    many = analysis.tangent_map(OSCILLATOR, "drift-kick", h, (2.0, 1.0), n_steps=7)
    assert np.allclose(many, np.linalg.matrix_power(kick @ drift, 7), rtol=0, atol=1e-12)


def test_tangents_of_the_pendulum_are_those_of_its_kicks():
    h, x, v = 0.1, 0.7, 0.4
    ratio = PENDULUM.params[0]
    kick = np.array([[1, 0], [-h * ratio * math.cos(x), 1]])
    expected = np.array([[1, h], [0, 1]]) @ kick
    assert np.allclose(analysis.tangent_map(PENDULUM, "kick-drift", h, (x, v)), expected, rtol=0, atol=1e-12)


def test_tangents_of_orbits_are_symplectic_and_their_chains_multiply():
    omega = np.kron([[0, 1], [-1, 0]], np.eye(2))
    one = analysis.tangent_map(KEPLER, "leapfrog", 0.05, increment=1e-3)
    assert np.abs(one.T @ omega @ one - omega).max() < 1e-11
    sol = kd.solve(KEPLER, (0.0, 0.1), step=0.05, method="leapfrog")
    next_ = analysis.tangent_map(KEPLER, "leapfrog", 0.05, (sol.x[1], sol.v[1]), increment=1e-3)
    both = analysis.tangent_map(KEPLER, "leapfrog", 0.05, n_steps=np.int64(2), increment=1e-3)
    assert np.allclose(next_ @ one, both, rtol=0, atol=1e-9)


def test_tangents_of_a_whole_orbit_are_symplectic():
    omega = np.kron([[0, 1], [-1, 0]], np.eye(2))
    whole = analysis.tangent_map(KEPLER, "velocity-verlet", 2 * math.pi / 300, n_steps=300)
    assert np.abs(whole).max() > 10
    assert np.abs(whole.T @ omega @ whole - omega).max() < 1e-9


def test_tangents_solve_the_variational_equations():
    x0, v0 = start(-0.25)

    def rates(t, y):
        x, tangent = y[:2], y[4:].reshape(4, 4)
        force = np.empty(2)
        henon_heiles(x, force)
        slope = np.array([[-1 - 2 * x[1], -2 * x[0]], [-2 * x[0], -1 + 2 * x[1]]])
        whole = np.block([[np.zeros((2, 2)), np.eye(2)], [slope, np.zeros((2, 2))]])
        return np.concatenate([y[2:4], force, (whole @ tangent).ravel()])

    y0 = np.concatenate([x0, v0, np.eye(4).ravel()])
    exact = solve_ivp(rates, (0.0, 10.0), y0, method="DOP853", rtol=1e-12, atol=1e-13).y[4:, -1].reshape(4, 4)
    found = analysis.tangent_map(henon_heiles, "kahan-li-8", 0.05, (x0, v0), n_steps=200, increment=1e-3)
    assert np.abs(found - exact).max() < 1e-7
    assert np.abs(exact).max() > 3


def test_tangents_of_first_order_equations_and_of_forces_that_depend_on_time():
    turning = kd.FirstOrder(lambda y: np.array([y[1], -y[0]]))
    found = analysis.tangent_map(turning, "implicit-midpoint", 0.2, ([1.0, 0.0], None), compile=False)
    rate = np.array([[0, 1], [-1, 0]])
    expected = np.linalg.solve(np.eye(2) - 0.1 * rate, np.eye(2) + 0.1 * rate)
    assert np.allclose(found, expected, rtol=0, atol=1e-8)
    found = analysis.tangent_map(lambda t, x: -x * t, "drift-kick", 0.1, (1.0, 0.0), t=2.0, compile=False)
    assert found[1, 0] == pytest.approx(-0.1 * 2.1, rel=1e-10)  # the clock moves with the drift


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"step": 0.0}, "step=0.0"),
        ({"n_steps": 0}, "n_steps=0"),
        ({"n_steps": True}, "n_steps=True"),
        ({"increment": 1.0}, "increment=1.0"),
    ],
)
def test_tangents_that_cannot_be_are_refused(options, reason):
    with pytest.raises(ArgumentError, match=reason):
        analysis.tangent_map(OSCILLATOR, "kick-drift", **{"step": 0.1, **options})


# Lyapunov exponents.


def test_a_saddle_has_the_exponents_of_the_method():
    h = 0.1
    rate = 2 * math.asinh(h / 2) / h  # of Verlet on x'' = x
    found = analysis.lyapunov_exponent(
        lambda x: x, (0.0, 200.0), 0.0, 0.0, step=h, method="leapfrog", count=2, compile=False
    )
    assert found.values == pytest.approx([rate, -rate], abs=1e-9)
    assert found.running[-1] == pytest.approx([rate, -rate], abs=0.05)
    assert rate < 1 - 1e-4


def test_the_standard_map_stretches_by_half_its_parameter_in_each_step():
    # Chirikov, Phys. Rep. 52, 263 (1979): ln(K / 2) for large K. Twenty such steps would tear a displacement of 1e-6 apart.
    found = analysis.lyapunov_exponent(
        lambda x: 10.0 * np.sin(x), (0.0, 5000.0), 0.4, 0.2, step=1.0, method="kick-drift", count=2, compile=False
    )
    assert found.values[0] == pytest.approx(math.log(5.0), abs=0.03)
    assert found.values.sum() == pytest.approx(0.0, abs=1e-3)


def test_displacements_at_a_fixed_point_may_outgrow_all_numbers_in_twenty_steps():
    found = analysis.lyapunov_exponent(
        lambda x: 40.0 * x**3 + 3.0 * x, (0.0, 200.0), 0.0, 0.0, step=1.0, method="kick-drift", compile=False
    )
    # Of v' = v + 3 x, x' = x + v': the larger eigenvalue of [[1, 3], [1, 4]]
    assert found.values[0] == pytest.approx(math.log((5.0 + math.sqrt(21.0)) / 2.0), abs=1e-3)


def test_friction_takes_from_the_sum():
    found = analysis.lyapunov_exponent(
        lambda x, v: -x - 0.3 * v, (0.0, 100.0), 1.0, 0.0, step=0.1, method="gauss-4", count=2
    )
    assert found.values.sum() == pytest.approx(-0.3, abs=1e-4)


def test_henon_and_heiles_are_chaotic_here_and_regular_there():
    # SciPy's DOP853 with the variational equations, rtol 1e-9, finds 0.045 to 0.060 after 1000 to 10,000 units of this orbit.
    chaotic = analysis.lyapunov_exponent(henon_heiles, (0.0, 2e4), *start(-0.25), step=0.1, count=2)
    assert 0.035 < chaotic.values[0] < 0.065
    assert abs(chaotic.values[1]) < 3e-3
    regular = analysis.lyapunov_exponent(henon_heiles, (0.0, 2e4), *start(0.1), step=0.1)
    assert regular.values[0] < 5e-4
    assert regular.running[-1, 0] < regular.running[regular.t.size // 4, 0] / 2


def test_all_four_come_in_pairs():
    found = analysis.lyapunov_exponent(henon_heiles, (0.0, 1000.0), *start(-0.25), step=0.1, count=4)
    assert found.values[:2] == pytest.approx(-found.values[:1:-1], abs=1e-4)


def test_the_same_call_gives_the_same_bits():
    one, other = (analysis.lyapunov_exponent(PENDULUM, (0.0, 50.0), step=0.1, count=2) for _ in range(2))
    assert np.array_equal(one.running, other.running)


@pytest.mark.parametrize(
    ("options", "reason"),
    [({"count": 0}, "count=0"), ({"count": 3}, "count=3"), ({"step": 20.0}, "at most the length")],
)
def test_exponents_that_cannot_be_are_refused(options, reason):
    with pytest.raises(ArgumentError, match=reason):
        analysis.lyapunov_exponent(PENDULUM, (0.0, 10.0), **{"step": 0.1, **options})


def test_states_that_are_lost_have_no_exponent():
    with pytest.raises(KickdriftError, match=r"is not finite"):
        analysis.lyapunov_exponent(lambda x: x**3, (0.0, 100.0), 1.0, 1.0, step=0.1, method="leapfrog", compile=False)


# Poincare sections.


def test_passages_of_two_oscillators_lie_on_an_ellipse():
    def rates(x):
        return np.array([-x[0], -2.0 * x[1]])

    section = analysis.poincare_section(
        rates, lambda x: x[0], (0.0, 300.0), [0.0, 1.0], [1.0, 0.5], step=0.05, method="kahan-li-8"
    )
    assert section.t == pytest.approx(2 * math.pi * np.arange(1, 48), abs=1e-8)
    assert np.abs(section.x[:, 0]).max() < 1e-10
    assert (section.v[:, 0] > 0).all()
    assert section.v[:, 1] ** 2 + 2 * section.x[:, 1] ** 2 == pytest.approx(2.25, abs=1e-8)
    assert np.ptp(section.x[:, 1]) > 2


def test_directions():
    counts = [
        analysis.poincare_section(
            OSCILLATOR, lambda x: x - 0.1, (0.0, 62.0), step=0.05, method="leapfrog", direction=way
        ).t.size
        for way in (-1, 0, 1)
    ]
    assert counts in ([10, 20, 10], [10, 19, 9])


def test_a_regular_orbit_makes_a_curve_and_a_chaotic_one_an_area(small_pictures, tmp_path):
    sections = [
        analysis.poincare_section(
            henon_heiles, lambda x: x[0], (0.0, 4000.0), *start(y), step=0.1, method="blanes-moan-srkn6b"
        )
        for y in (0.1, -0.25)
    ]
    areas = []
    for section in sections:
        cells = np.floor(np.stack([section.x[:, 1], section.v[:, 1]], axis=1) / 0.04)
        areas.append(len(np.unique(cells, axis=0)) / section.t.size)
    assert areas[0] < 0.5 * areas[1]
    figure = plots.plot_poincare_sections(sections, tmp_path / "section.png")
    (panel,) = figure.axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("x[1]", "v[1]")
    assert [line.get_xdata().size for line in panel.lines] == [section.t.size for section in sections]
    (panel,) = sections[0].plot(axes=("x[1]", "v[0]")).axes
    assert np.array_equal(panel.lines[0].get_ydata(), sections[0].v[:, 0])
    with pytest.raises(ArgumentError, match=r"the state has x\[0\], x\[1\]"):
        sections[0].plot(axes=("x[2]", "v[0]"))
    with pytest.raises(ArgumentError, match="sections is empty"):
        plots.plot_poincare_sections([])


def test_the_events_of_a_solution_are_a_section():
    sol = kd.solve(OSCILLATOR, (0.0, 20.0), step=0.05, events=[lambda v: v, lambda x: x])
    section = analysis.poincare_section(sol, 1)
    assert repr(section).startswith(f"<PoincareSection of {section.system}: {section.t.size} crossings from t=")
    assert np.array_equal(section.t, sol.t_events[1])
    assert np.array_equal(section.v, sol.v_events[1])
    for number in (2, -1, None):
        with pytest.raises(ArgumentError, match="is not an event of the solution"):
            analysis.poincare_section(sol, number)


def test_sections_that_cannot_be_are_refused():
    with pytest.raises(ArgumentError, match="are needed"):
        analysis.poincare_section(OSCILLATOR, lambda x: x)
    with pytest.raises(ArgumentError, match="direction=2"):
        analysis.poincare_section(OSCILLATOR, lambda x: x, (0.0, 1.0), step=0.1, direction=2)
    with pytest.raises(ArgumentError, match="is not a function"):
        analysis.poincare_section(OSCILLATOR, "x", (0.0, 1.0), step=0.1)


def test_bodies_that_merge_are_refused_by_one_sentence():
    planets = kd.systems.planetary([1, 1e-3], [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 1, 0]], radii=[0.01, 0.001])
    for call in (
        lambda: analysis.lyapunov_exponent(planets, (0, 1.0), step=0.1),
        lambda: kd.advise(planets, (0, 1.0), 1e-6),
    ):
        with pytest.raises(ArgumentError, match="Leave the radii out") as refused:
            call()
        assert str(refused.value).count("have radii, and") == 1


def test_exponents_are_shown_on_one_line():
    found = analysis.lyapunov_exponent(lambda x: x, (0.0, 20.0), [1e-3], [0.0], step=0.05, compile=False)
    assert repr(found) == "<LyapunovExponents 1.002 per unit of time, from 20 renormalisations to t=20>"
