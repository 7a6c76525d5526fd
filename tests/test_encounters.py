"""Planets that meet: the switch between a Wisdom-Holman word and integration, its symmetry, and what it keeps."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.core.outcomes import Outcome
from kickdrift.methods.nystrom import DORMAND_12

NAME = "wisdom-holman-switched"
METHOD = kd.methods.get(NAME)


def quiet_planets(mass=1e-3):
    x = np.array([[0.1, 0.2, 0.0], [1.1, 0.2, 0.0], [0.1, -1.9, 0.1]])
    v = np.array([[0.0, 0.01, 0.02], [0.0, 1.06, 0.02], [0.71, 0.01, 0.02]])
    return kd.systems.planetary([1.0, mass, mass / 2], x, v)


def scattering_planets(seed=1):
    """Three planets of Jupiter's mass so close to each other that they meet within some periods."""
    rng = np.random.default_rng(seed)
    masses, a = [1.0, 1e-3, 1e-3, 1e-3], np.array([1.0, 1.2, 1.44])
    angle = rng.uniform(0, 2 * np.pi, 3)
    x, v = np.zeros((2, 4, 3))
    x[1:] = a[:, None] * np.stack([np.cos(angle), np.sin(angle), 0.01 * rng.normal(size=3)], axis=1)
    v[1:] = a[:, None] ** -0.5 * np.stack([-np.sin(angle), np.cos(angle), 0.01 * rng.normal(size=3)], axis=1)
    return kd.systems.planetary(masses, x, v)


def fly_by(masses=(1.0, 1e-3, 1e-3)):
    """Two planets that pass each other once within three units of time, at a thirtieth of the radius of Hill."""
    x = [[0, 0, 0], [1, 0, 0], [1.03 * np.cos(0.07), 1.03 * np.sin(0.07), 0]]
    v = [[0, 0, 0], [0, 1, 0], [-0.95 * np.sin(0.07), 0.95 * np.cos(0.07), 0]]
    return kd.systems.planetary(masses, x, v)


def run(system, step, end, method=NAME, **options):
    return kd.solve(system, (0.0, end), step=step, method=method, progress=False, **{"save_every": 2**40} | options)


def reference(system, end):
    return run(system, None, end, "dop853", rtol=1e-13, atol=1e-14)


def distance(one, other):
    return max(np.abs(one.x[-1] - other.x[-1]).max(), np.abs(one.v[-1] - other.v[-1]).max())


def energy_error(sol):
    return np.abs(sol.energy / sol.energy[0] - 1).max()


# The integration


def test_the_tableau_fulfils_the_conditions_of_its_order():
    t = DORMAND_12
    assert np.abs(t.a.sum(axis=1) - t.c**2 / 2).max() < 1e-14
    assert np.abs(t.b - t.b_of_v * (1 - t.c)).max() < 1e-15
    assert not np.triu(t.a).any()

    def conditions(b_of_v, b):
        powers = np.arange(12)
        of_v = (b_of_v * t.c ** powers[:, None]).sum(axis=1) - 1 / (powers + 1)
        of_x = (b * t.c ** powers[:, None]).sum(axis=1) - 1 / ((powers + 1) * (powers + 2))
        return np.abs(of_v) < 1e-15, np.abs(of_x) < 1e-15

    assert conditions(t.b_of_v, t.b)[0].all()
    of_v, of_x = conditions(t.b_of_v - t.error_of_v, t.b - t.error)
    assert of_v.tolist() == [True] * 10 + [False] * 2
    assert of_x.tolist() == [True] * 9 + [False] * 3


# Without encounters


def test_without_encounters_it_is_the_word_in_jacobi_coordinates():
    system = quiet_planets()
    sol = run(system, 0.3, 30.0)
    assert sol.n_rejected == 0
    assert sol.n_force_evaluations == 100 * 8
    assert distance(sol, run(system, 0.3, 30.0, "blanes-aba-1064")) < 1e-12
    assert distance(sol, run(system, 0.3, 30.0, "wisdom-holman")) > 1e-5


@pytest.mark.parametrize("splitting", ["jacobi", "democratic-heliocentric"])
def test_the_order_is_that_of_the_word_where_no_step_is_taken_back(splitting):
    tolerant = replace(METHOD, parameters=(Fraction(1, 10), 1, *METHOD.parameters[2:]))
    x, v = quiet_planets().x0, quiet_planets().v0
    system = kd.systems.planetary([1.0, 0.1, 0.05], x, v, splitting=splitting)
    exact, errors = reference(system, 2.0), []
    for step in (0.4, 0.2):
        sol = run(system, step, 2.0, tolerant)
        assert sol.n_rejected == 0
        word = run(kd.systems.planetary([1.0, 0.1, 0.05], x, v), step, 2.0, "blanes-aba-1064")
        assert distance(sol, word) < 1e-14
        errors.append(distance(sol, exact))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(METHOD.order, abs=0.2)


def test_bodies_may_be_given_in_any_order():
    system = quiet_planets()
    turned = kd.systems.planetary([1.0, 5e-4, 1e-3], system.x0[[0, 2, 1]], system.v0[[0, 2, 1]])

    def difference(method):
        return np.abs(run(system, 0.3, 30.0, method).x[-1] - run(turned, 0.3, 30.0, method).x[-1][[0, 2, 1]]).max()

    assert difference(NAME) < 1e-13
    assert difference("wisdom-holman") > 1e-5  # which has the Jacobi coordinates of the order given


# Encounters


def test_an_encounter_is_integrated_and_the_word_alone_misses_it():
    system = fly_by()
    exact = reference(system, 3.0)
    x = run(system, 0.02, 3.0, save_every=1).x
    assert np.linalg.norm(x[:, 1] - x[:, 2], axis=1).min() == pytest.approx(0.0025, abs=1e-5)
    assert distance(run(system, 0.3, 3.0), exact) < 1e-7
    for method in ("blanes-aba-1064", "wisdom-holman"):
        assert distance(run(system, 0.3, 3.0, method), exact) > 0.1


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_scattering_planets_keep_their_energy(seed):
    system = scattering_planets(seed)
    sol = run(system, 0.3, 2000.0, save_every=50)
    assert sol.success
    assert 0 < sol.n_rejected < sol.n_steps
    assert energy_error(sol) < 1e-8
    for name in ("momentum", "angular momentum"):
        assert np.abs(sol.invariants[name] - sol.invariants[name][0]).max() < 1e-11
    assert energy_error(run(system, 0.3, 2000.0, "wisdom-holman", save_every=50)) > 1e-2


def test_a_close_approach_to_the_star_is_integrated():
    e, mass = 0.995, 1e-3
    x = [[0, 0, 0], [1 + e, 0, 0], [0, 0.5, 0.0]]
    v = [[0, 0, 0], [0, np.sqrt((1 - e) / (1 + e)), 0], [-np.sqrt(2), 0, 0]]
    system = kd.systems.planetary([1.0, mass, mass], x, v)
    sol = run(system, 0.1, 20.0, save_every=1)
    assert sol.n_rejected == 9
    assert energy_error(sol) < 1e-9
    assert distance(sol, reference(system, 20.0)) < 1e-7
    assert energy_error(run(system, 0.1, 20.0, "wisdom-holman", save_every=1)) > 1e-5


def test_steps_lead_back_to_the_start_through_an_encounter():
    system = fly_by()
    for step in (0.3, 0.1):
        there = run(system, step, 3.0)
        assert there.n_rejected > 0
        back = kd.solve(
            system, (3.0, 0.0), there.x[-1], there.v[-1], step=step, method=NAME, progress=False, save_every=2**40
        )
        assert back.n_rejected == there.n_rejected
        assert np.abs(back.x[-1] - system.x0).max() < 1e-8
        assert np.abs(back.v[-1] - system.v0).max() < 1e-8
    quiet = quiet_planets()
    there = run(quiet, 0.3, 30.0)
    back = kd.solve(quiet, (30.0, 0.0), there.x[-1], there.v[-1], step=0.3, method=NAME, progress=False)
    assert max(np.abs(back.x[-1] - quiet.x0).max(), np.abs(back.v[-1] - quiet.v0).max()) < 1e-12


def test_steps_are_taken_back_where_they_are_wrong_and_nowhere_else():
    system = fly_by()
    sol = run(system, 0.3, 3.0, save_every=1)
    one_by_one = [
        kd.solve(system, (0.0, 0.3), x, v, step=0.3, method=NAME, progress=False).n_rejected
        for x, v in zip(sol.x[:-1], sol.v[:-1], strict=True)
    ]
    assert one_by_one[:5] == [1] * 5
    assert one_by_one[-3:] == [0] * 3
    assert sol.n_rejected == sum(one_by_one)
    assert f"{sol.n_rejected} more rejected" in sol.report()
    unconcerned = replace(METHOD, parameters=(Fraction(1, 1000), 10**6, *METHOD.parameters[2:]))
    assert run(system, 0.3, 3.0, unconcerned).n_rejected < 5
    assert distance(run(system, 0.3, 3.0, unconcerned), sol) > 1e-5


@pytest.mark.parametrize("mass", [0.0, 1e-9])
def test_light_bodies_are_scattered_as_well_as_heavy_ones(mass):
    system = fly_by((1.0, 1e-3, mass))
    sol = run(system, 0.2, 3.0)
    assert sol.n_rejected > 0
    assert distance(sol, reference(system, 3.0)) < 1e-8


@pytest.mark.parametrize("mass", [0.0, 1e-9])
def test_comets_that_come_from_beyond_a_planet_pass_the_star_closely(mass):
    a, e = 2.5, 0.98
    x = [[0, 0, 0], [1, 0, 0], [0, a * (1 + e), 0.3]]
    v = [[0, 0, 0], [0, 1, 0], [-np.sqrt((1 - e) / (1 + e) / a), 0, 0]]
    system = kd.systems.planetary([1.0, 1e-3, mass], x, v)
    period = 2 * np.pi * a**1.5
    assert distance(run(system, 0.3, period), reference(system, period)) < 1e-6


# With all the rest


def test_rows_between_and_restarts_have_the_bits_of_the_run(tmp_path):
    system = scattering_planets(2)
    whole = run(system, 0.3, 300.0, save_every=1)
    some = run(system, 0.3, 300.0, save_every=None, t_eval=whole.t[[10, 500, -1]])
    assert np.array_equal(some.x, whole.x[[10, 500, -1]])
    half = run(system, 0.3, 150.0, save_every=1)
    assert np.array_equal(half.continue_to(300.0).x[-1], whole.x[-1])
    between = whole(0.5 * (whole.t[3] + whole.t[4]))
    assert np.abs(between.x - reference(system, 0.5 * (whole.t[3] + whole.t[4])).x[-1]).max() < 1e-6
    run(system, 0.3, 150.0, checkpoint=tmp_path / "kept")
    assert np.array_equal(run(system, 0.3, 300.0, checkpoint=tmp_path / "kept").x[-1], whole.x[-1])


def test_systems_that_are_no_bodies_are_refused():
    with pytest.raises(MethodMismatchError, match=r"kd\.systems\.planetary"):
        run(kd.systems.kepler(0.5), 0.1, 1.0)
    x, v = np.eye(3), np.zeros((3, 3))
    with pytest.raises(MethodMismatchError, match="light bodies"):
        run(kd.systems.nbody([1, 1e-3, 1e-3], x, v), 0.1, 1.0)


def test_a_collision_of_points_ends_the_run_with_a_sentence():
    x, v = [[0, 0, 0], [1, 0, 0], [1.1, 0, 0]], np.zeros((3, 3))
    sol = run(kd.systems.planetary([1.0, 1e-3, 1e-3], x, v), 0.1, 5.0)
    assert sol.status is Outcome.NO_STEP
    assert "No valid size" in sol.message


@pytest.mark.parametrize("restitution", [1.0, 0.0])
def test_points_that_meet_head_on_within_a_step_rebound_from_their_surfaces(restitution):
    system = kd.systems.planetary([1.0, 1e-3, 1e-3], [[0, 0, 0], [1, 0, 0], [1.1, 0, 0]], np.zeros((3, 3)))
    spheres = kd.Impacts(kd.sphere_gaps([0.005, 0.01, 0.01]), restitution=restitution)
    sol = run(system, 0.3, 1.5, impacts=spheres)
    fine = kd.solve(system, (0.0, 1.5), step=2e-4, method="dop853", impacts=spheres, progress=False)
    assert sol.status is Outcome.COMPLETED
    assert np.abs(sol.x[-1] - fine.x[-1]).max() < 1e-6


# Mergers


def head_on(radii=(0.01, 0.03, 0.03), masses=(1.0, 1e-3, 5e-4)):
    x = [[0, 0, 0], [1, 0, 0], [1.3, 0.05, 0]]
    v = [[0, 0, 0], [0.1, 1.0, 0], [-0.2, 0.85, 0.01]]
    return kd.systems.planetary(masses, x, v, radii=radii)


def contact_of(system, one, other, end=10.0):
    """Where the centres of two bodies are as far apart as their radii, by another method."""
    distance = system.radii[one] + system.radii[other]

    def touch(x):
        return np.sqrt(((x[one] - x[other]) ** 2).sum()) - distance

    touch.terminal = True
    points = kd.systems.planetary(system.gm, system.x0, system.v0)
    return kd.solve(points, (0, end), rtol=1e-13, atol=1e-14, method="dop853", events=touch, progress=False)


@pytest.mark.filterwarnings("error")
def test_radii_may_be_zero():
    assert kd.systems.planetary([1.0, 0.0], [[0, 0, 0], [2, 0, 0]], np.zeros((2, 3)), radii=[0, 0]).radii.tolist() == [
        0,
        0,
    ]


@pytest.mark.parametrize("density", ["distance", "acceleration"])
def test_a_density_by_distances_is_refused_for_bodies_that_merge(density):
    with pytest.raises(ArgumentError, match="have merged"):
        run(head_on(), 0.2, 4.0, step_control=density)


def test_of_two_contacts_within_a_step_the_first_comes_first():
    x, v = [[0, 0, 0], [1, 0, 0], [-1, 0, 0]], [[0, 0, 0], [0, 0.01, 0], [0, 0.001, 0]]
    system = kd.systems.planetary([1.0, 1e-3, 1e-3], x, v, radii=[0.05, 0.001, 0.001])
    sol = run(system, 0.2, 2.0, save_every=1)
    first, second = kd.analysis.mergers(sol)
    assert (first.bodies, second.bodies) == (("0", "2"), ("0", "1"))
    assert first.energy_lost > 0.0 < second.energy_lost
    for t in np.linspace(first.t, second.t, 50)[1:-1]:
        assert len(np.unique(sol(t).x, axis=0)) == 2


def test_bodies_that_touch_merge_and_keep_mass_momentum_and_centre_of_mass():
    system, m = head_on(), np.array([1.0, 1e-3, 5e-4])
    sol = run(system, 0.2, 10.0, "auto", save_every=1)
    assert sol.success
    assert sol.about.method == NAME
    before = contact_of(system, 1, 2)
    (merger,) = kd.analysis.mergers(sol)
    assert merger.bodies == ("1", "2")
    assert merger.t == pytest.approx(before.t[-1], abs=1e-7)
    u = before.v[-1, 1] - before.v[-1, 2]
    assert merger.energy_lost == pytest.approx(0.5 * m[1] * m[2] / (m[1] + m[2]) * u @ u, rel=1e-6)
    x, v = ((m[1] * y[-1, 1] + m[2] * y[-1, 2]) / (m[1] + m[2]) for y in (before.x, before.v))
    one = kd.systems.planetary([1.0, 1.5e-3], [before.x[-1, 0], x], [before.v[-1, 0], v])
    assert sol.energy[-1] == pytest.approx(run(one, 0.1, 0.1).energy[0], rel=1e-8)
    assert sol.energy[0] - sol.energy[-1] > 1e-6
    merged = sol.t > merger.t
    assert np.array_equal(sol.x[merged, 1], sol.x[merged, 2])
    assert np.array_equal(sol.v[merged, 1], sol.v[merged, 2])
    assert np.abs(sol.energy[merged] - sol.energy[-1]).max() < 1e-15
    assert np.abs(sol.invariants["momentum"] - sol.invariants["momentum"][0]).max() < 1e-16
    centre = np.einsum("i,tik->tk", m, sol.x) / m.sum()
    drift = sol.t[:, None] * (m @ system.v0) / m.sum()
    assert np.abs(centre - centre[0] - drift).max() < 1e-15


def test_what_has_merged_moves_as_one_body_would():
    system = head_on()
    sol = run(system, 0.2, 10.0, save_every=1)
    x, v = sol.x[10, :2], sol.v[10, :2]
    one = kd.systems.planetary([1.0, 1.5e-3], x, v)
    alone = kd.solve(one, (sol.t[10], 10.0), rtol=1e-13, atol=1e-14, method="dop853", progress=False)
    assert np.abs(alone.x[-1] - sol.x[-1, :2]).max() < 1e-12


def test_states_between_rows_and_continued_runs_know_who_has_merged(tmp_path):
    whole = run(head_on(), 0.2, 10.0, save_every=1)
    assert np.array_equal(run(head_on(), 0.2, 5.0, save_every=1).continue_to(10.0).x[-1], whole.x[-1])
    (merger,) = kd.analysis.mergers(whole)
    just_before, just_after = whole(merger.t - 1e-6), whole(merger.t + 1e-6)
    assert np.abs(just_before.v[1] - just_before.v[2]).max() > 0.1
    assert np.array_equal(just_after.v[1], just_after.v[2])
    whole.save(tmp_path / "whole.npz")
    (loaded,) = kd.analysis.mergers(kd.load(tmp_path / "whole.npz"))
    assert loaded.t == whole.t[whole.t > merger.t][0]
    assert np.isnan(loaded.energy_lost)
    varied = {"step_control": kd.HairerSoderlind()}
    (late,) = kd.analysis.mergers(run(head_on(), 0.2, 10.0, **varied))
    assert late.t > 9.0
    assert np.isnan(late.energy_lost)
    (every,) = kd.analysis.mergers(run(head_on(), 0.2, 10.0, save_every=1, **varied))
    assert every.t == pytest.approx(merger.t, abs=1e-7)
    assert every.energy_lost == pytest.approx(merger.energy_lost, rel=1e-6)
    sparse = run(head_on(), 0.2, 10.0)
    assert kd.analysis.mergers(sparse)[0].t == pytest.approx(merger.t, abs=1e-12)


@pytest.mark.parametrize("gap", [1 - 1e-4, 1 + 1e-4])
def test_a_graze_is_a_contact_or_none_by_its_shortest_distance(gap):
    closest = 0.0025005
    points = run(fly_by(), 0.001, 1.0, save_every=1)
    distances = np.linalg.norm(points.x[:, 1] - points.x[:, 2], axis=1)
    k = int(distances.argmin())
    times = np.linspace(points.t[k - 1], points.t[k + 1], 2001)
    x = points(times).x
    closest = np.linalg.norm(x[:, 1] - x[:, 2], axis=1).min()
    system = fly_by()
    radii = [0.0, 0.5 * gap * closest, 0.5 * gap * closest]
    grazing = kd.systems.planetary([1.0, 1e-3, 1e-3], system.x0, system.v0, radii=radii)
    for step in (0.3, 0.05):
        found = kd.analysis.mergers(run(grazing, step, 3.0))
        assert len(found) == (gap > 1)


def test_planets_that_fall_into_the_star_and_onto_each_other():
    x = [[0, 0, 0], [1, 0, 0], [3, 0, 0], [3.4, 0.0, 0]]
    v = [[0, 0, 0], [0, 0.05, 0], [0, 0.57, 0], [-0.1, 0.55, 0]]
    masses = [1.0, 1e-3, 2e-3, 1e-3]
    system = kd.systems.planetary(masses, x, v, radii=[0.02, 0.001, 0.05, 0.05], names=["S", "a", "b", "c"])
    sol = run(system, 0.3, 20.0)
    assert sol.success
    assert [merger.bodies for merger in kd.analysis.mergers(sol)] == [("S", "a"), ("b", "c")]
    assert np.array_equal(sol.x[-1, 0], sol.x[-1, 1])
    assert np.abs(sol.invariants["momentum"][-1] - sol.invariants["momentum"][0]).max() < 1e-15


def test_large_bodies_touch_before_the_gravity_of_the_other_shows():
    radii = (0.1, 0.05, 0.05)
    system = head_on(radii, (1.0, 1e-9, 0.0))
    (merger,) = kd.analysis.mergers(run(system, 0.4, 5.0))
    assert merger.t == pytest.approx(contact_of(system, 1, 2).t[-1], abs=1e-8)
    assert abs(merger.energy_lost) < 1e-20


@pytest.mark.parametrize(
    ("radii", "reason"),
    [
        ([0.1, 0.1], "3 finite numbers"),
        ([0.1, -0.1, 0.1], "3 finite numbers"),
        ([0.1, np.inf, 0.1], "3 finite numbers"),
        ("many", "must be numbers"),
        ([0.1, 0.3, 0.1], "bodies 1 and 2 overlap"),
    ],
)
def test_radii_that_cannot_be_are_refused(radii, reason):
    with pytest.raises(ArgumentError, match=reason):
        head_on(radii)


@pytest.mark.parametrize(
    ("end", "options", "reason"),
    [(-10.0, {}, "runs backwards"), (10.0, {"impacts": kd.sphere_gaps([0.01, 0.001, 0.001])}, "leave one of them out")],
)
def test_bodies_that_merge_neither_rebound_nor_come_apart(end, options, reason):
    x0, v0 = [[0, 0, 0], [1, 0, 0], [-1.5, 0, 0]], [[0, 0, 0], [0, 1, 0], [0, -0.8, 0]]
    system = kd.systems.planetary([1.0, 1e-3, 1e-3], x0, v0, radii=[0.01, 0.001, 0.001])
    with pytest.raises(ArgumentError, match=reason):
        kd.solve(system, (0.0, end), step=0.1, **options)


def test_bodies_with_radii_are_refused_by_methods_that_do_not_see_them():
    with pytest.raises(MethodMismatchError, match="does not detect contact"):
        run(head_on(), 0.1, 1.0, "wisdom-holman")
    with pytest.raises(ArgumentError, match=r"radii=\.\.\."):
        kd.analysis.mergers(run(kd.systems.kepler(0.1), 0.1, 1.0, "wisdom-holman"))
    assert kd.analysis.mergers(run(quiet_planets(), 0.3, 1.0)) == ()


def test_radii_have_the_unit_of_lengths():
    u, constants = pytest.importorskip("astropy.units"), pytest.importorskip("astropy.constants")
    x, v = (
        np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]]) * u.au,
        np.array([[0, 0, 0], [0, 30, 0], [-20, 0, 0]]) * u.km / u.s,
    )
    bodies = [1, 1e-3, 1e-3] * u.Msun, x, v, constants.G
    system = kd.systems.planetary(*bodies, radii=[7e5, 7e4, 7e4] * u.km)
    assert system.radii == pytest.approx(np.array([7e5, 7e4, 7e4]) / 149597870.7)
    for radii, reason in (([7e5, 7e4, 7e4], "no unit"), ([1, 1, 1] * u.kg, "radii")):
        with pytest.raises(ArgumentError, match=reason):
            kd.systems.planetary(*bodies, radii=radii)


# Together with others


def test_members_of_an_ensemble_are_runs_of_their_own():
    system = fly_by()
    v0 = np.repeat(system.v0[None], 3, axis=0)
    v0[:, 2, 2] = [0.0, 0.01, 0.02]
    members = kd.solve_ensemble(system, (0.0, 3.0), x0=np.stack([system.x0] * 3), v0=v0, step=0.3, method=NAME)
    alone = kd.solve(system, (0.0, 3.0), system.x0, v0[1], step=0.3, method=NAME, progress=False)
    assert np.array_equal(members.x[1, -1], alone.x[-1])


def test_planets_rebound_where_impacts_are_asked_for():
    system = fly_by()
    m, bounce = np.array([1.0, 1e-3, 1e-3]), kd.Impacts(kd.sphere_gaps([1e-3, 2e-3, 2e-3]), restitution=0.5)
    sol = run(system, 0.01, 3.0, impacts=bounce, save_every=1)
    x, v = sol.x[:, 1] - sol.x[:, 2], sol.v[:, 1] - sol.v[:, 2]
    assert np.linalg.norm(x, axis=1).min() == pytest.approx(4e-3, abs=1e-9)
    closing = (x * v).sum(axis=1) / np.linalg.norm(x, axis=1)
    assert (np.diff(np.sign(closing)) > 0).any()
    assert np.abs(sol.invariants["momentum"] - sol.invariants["momentum"][0]).max() < 1e-15
    assert np.abs(np.einsum("i,tik->tk", m, sol.v) - m @ system.v0).max() < 1e-15


def test_other_controls_of_steps_and_events_go_with_it():
    system = fly_by()
    varied = run(system, 0.3, 3.0, step_control=kd.HairerSoderlind(), save_every=1)
    assert energy_error(varied) < 1e-8
    assert varied.t[-1] == 3.0
    sol = run(system, 0.3, 3.0, events=lambda x: x[1, 1])
    assert sol.t_events[0].size == 1
    assert abs(sol.x_events[0][0][1, 1]) < 1e-12
