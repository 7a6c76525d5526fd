"""Quantities of astropy and pint: in at the door, out on the solution, and no length where a time is wanted."""

import pickle

import numpy as np
import pytest

import kickdrift as kd
from kickdrift import analysis
from kickdrift.core.errors import ArgumentError


@pytest.fixture(params=["astropy.units", "pint"])
def u(request):
    module = pytest.importorskip(request.param)
    return module if request.param == "astropy.units" else module.UnitRegistry()


def number(quantity, unit):
    converted = quantity.to(unit)
    return getattr(converted, "value", None) if hasattr(converted, "value") else converted.magnitude


def spring(x):
    return -x


def run(u, **options):
    given = {
        "t_span": (0 * u.s, 10 * u.s), "x0": [1.0, 2.0] * u.m, "v0": [0.0, 3.0] * u.m / u.s, "step": 10 * u.ms,
        "method": "leapfrog", "compile": False,
    }  # fmt: skip
    return kd.solve(spring, **{**given, **options})


def test_a_run_in_units_has_the_numbers_of_one_without(u):
    sol = run(u)
    plain = kd.solve(spring, (0, 10), [1.0, 2.0], [0.0, 3.0], step=0.01, method="leapfrog", compile=False)
    assert np.array_equal(number(sol.x, u.m), plain.x)
    assert np.array_equal(number(sol.v, u.m / u.s), plain.v)
    assert np.array_equal(number(sol.t, u.s), plain.t)
    assert np.array_equal(sol.plain.x, plain.x)
    assert type(sol.plain) is kd.Solution
    assert number(sol.step, u.ms) == pytest.approx(10.0)
    assert isinstance(sol, kd.Solution)
    assert sol.about.units == {"t": "s", "x": "m", "v": "m/s"}


def test_units_are_those_of_the_user_whatever_they_are(u):
    sol = run(u, t_span=(0 * u.s, 1 / 6 * u.minute), x0=[0.1, 0.2] * u.km, v0=[0.0, 360.0] * u.km / u.hour)
    assert number(sol.x, u.km)[0] == pytest.approx([0.1, 0.2])
    assert number(sol.v[0], u.m / u.s) == pytest.approx([0.0, 100.0])
    slow = kd.solve(spring, (0, 10), [100.0, 200.0], [0.0, 100.0], step=0.01, method="leapfrog", compile=False)
    assert number(sol.x, u.m) == pytest.approx(slow.x, rel=1e-12)
    assert number(sol.v, u.m / u.s) == pytest.approx(slow.v, rel=1e-12, abs=1e-9)


def test_what_else_has_units(u):
    def rising(x):
        return x[0]

    sol = run(u, t_eval=[0.0, 0.05] * u.minute, events=rising)
    assert number(sol.t, u.s) == pytest.approx([0.0, 3.0])
    assert number(sol.t_events[0], u.s) == pytest.approx(np.pi / 2 * np.array([1, 3, 5]), abs=1e-4)
    assert np.abs(number(sol.x_events[0], u.m)[:, 0]).max() < 1e-9
    x, v = sol(1000 * u.ms)
    assert number(x, u.m)[0] == pytest.approx(np.cos(1.0), abs=1e-4)
    assert number(v, u.m / u.s)[0] == pytest.approx(-np.sin(1.0), abs=1e-4)
    assert np.array_equal(number(sol.q, u.m), number(sol.x, u.m))


def test_angles_without_a_unit_have_rates_over_time(u):
    sol = run(u, x0=1.0, v0=0.0)
    assert isinstance(sol.x, np.ndarray)
    assert not hasattr(sol.x, "to")
    assert number(sol.t, u.s)[-1] == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (lambda u: {"t_span": (0 * u.m, 1 * u.m)}, "is in m, which is not a unit of time"),
        (lambda u: {"t_span": (0, 1)}, r"t_span=\(0, 1\) has no unit"),
        (lambda u: {"step": 1 * u.m}, "step=.* has the unit m, which cannot be converted to s"),
        (lambda u: {"step": 0.1}, "step=0.1 has no unit"),
        (lambda u: {"v0": [1, 1] * u.m}, "v0=.* has the unit m, which cannot be converted to m/s"),
        (lambda u: {"v0": [1.0, 1.0]}, "v0=1.0 has no unit"),
        (lambda u: {"x0": [1.0, 1.0]}, "v0=.* has the unit m/s, which cannot be converted to 1/s"),
        (lambda u: {"t_eval": [1.0] * u.kg}, "t_eval=.* has the unit kg, which cannot be converted to s"),
        (lambda u: {"args": (1 * u.m,)}, "args=.* must be numbers"),
    ],
)
def test_what_measures_something_else_is_refused(u, wrong, reason):
    with pytest.raises(ArgumentError, match=reason):
        run(u, **wrong(u))


def test_it_reports_saves_draws_and_goes_to_other_processes(u, tmp_path, small_pictures):
    sol = run(u)
    assert "0.01 s" in sol.report()
    assert np.array_equal(kd.load(sol.save(tmp_path / "a.npz")).x, sol.plain.x)
    assert sol.plot(tmp_path / "a.png").axes[0].get_xlabel()
    copy = pickle.loads(pickle.dumps(sol.plain))
    assert np.array_equal(copy.x, sol.plain.x)
    assert "1000 steps of 0.01" in repr(sol)
    if pytest.importorskip("xarray"):
        assert sol.to_xarray().x.attrs["units"] == "m"


def test_units_are_refused_where_they_would_be_lost(u):
    with pytest.raises(ArgumentError, match=r"omega=.* must be a number: it has a unit, which would be lost"):
        kd.systems.harmonic_oscillator(1.0 / u.s)
    stiffnesses = np.array([1.0, 2.0]) / u.s**2
    with pytest.raises(ArgumentError, match=r"args\['k'\] has a unit, which would be lost"):
        kd.solve_ensemble(
            lambda x, params: -params[0] * x, (0.0, 1.0), x0=1.0, v0=0.0, step=0.1, args={"k": stiffnesses}
        )


def test_planets_in_their_own_units():
    u, constants = pytest.importorskip("astropy.units"), pytest.importorskip("astropy.constants")
    x, v = [[0, 0, 0], [1, 0, 0]] * u.au, [[0, 0, 0], [0, 29.784691831, 0]] * u.km / u.s
    system = kd.systems.planetary([1, 3e-6] * u.Msun, x, v, G=constants.G)
    sol = kd.solve(system, (0, 1) * u.yr, step=1 * u.day, method="wisdom-holman")
    assert sol.t.unit == u.yr
    assert sol.t[-1].value == pytest.approx(1.0)
    assert sol.x[-1, 1].to_value(u.km) == pytest.approx([1.496e8, 0.0, 0.0], rel=1e-3, abs=2e6)
    assert sol.v.unit == u.km / u.s
    assert analysis.orbital_elements(sol.plain).a == pytest.approx(1.0, abs=1e-4)
    assert np.abs(sol.energy / sol.energy[0] - 1).max() < 1e-10
    with pytest.raises(ArgumentError, match="G has no unit"):
        kd.systems.nbody([1, 1] * u.kg, x, v, G=1.0)
    with pytest.raises(ArgumentError, match="is not a velocity"):
        kd.systems.nbody([1, 1] * u.kg, x, x, G=constants.G)
    with pytest.raises(ArgumentError, match=r"softening=.* has no unit"):
        kd.systems.nbody([1, 1] * u.kg, x, v, G=constants.G, softening=0.1)
    with pytest.raises(ArgumentError, match=r"t_span=\(0, 1\) has no unit"):
        kd.solve(system, (0, 1), step=0.1)


def test_systems_in_numbers_take_no_units(u):
    with pytest.raises(ArgumentError, match="has numbers without units"):
        kd.solve(kd.systems.kepler(), (0 * u.s, 1 * u.s), step=0.1 * u.s)


def test_masses_in_units(u):
    heavy = kd.Newtonian(lambda x: -8 * x, mass=2 * u.kg)
    sol = kd.solve(heavy, (0 * u.s, 1 * u.s), 1 * u.m, 0 * u.m / u.s, step=0.5 * u.s, method="leapfrog", compile=False)
    assert number(sol.x, u.m) == pytest.approx([1.0, 0.5, -0.5])


def test_what_judges_and_draws_solutions_takes_them_with_units(u, small_pictures):
    problem = kd.SecondOrder(spring, energy=lambda x, v: 0.5 * (x @ x + v @ v))
    given = (0 * u.s, 20 * u.s), [1 * u.m, 0.002 * u.km], [0 * u.m / u.s, 0 * u.m / u.s]
    coarse, fine = (kd.solve(problem, *given, step=h * u.s, method="leapfrog", compile=False) for h in (0.1, 0.01))
    assert analysis.phase_drift(coarse, fine) == pytest.approx(0.1**2 / 24, rel=0.05)
    assert abs(analysis.energy_drift(coarse)) < 1e-3
    assert len(kd.plots.plot_energy_comparison({"coarse": coarse, "fine": fine}).axes) == 1
    assert coarse.plain.plain.t[-1] == 20.0
    pytest.importorskip("pandas")
    assert coarse.to_pandas().attrs["units"]["x[0]"] == "m"


def test_it_goes_on_in_its_units(u):
    sol, longer = run(u, t_span=(0 * u.s, 5 * u.s)), run(u)
    further = sol.continue_to(10_000 * u.ms)
    assert np.array_equal(further.plain.x, longer.plain.x)
    assert np.array_equal(number(further.x, u.m), number(longer.x, u.m))
    with pytest.raises(ArgumentError, match=r"t=.* has no unit"):
        sol.continue_to(10.0)


def test_what_takes_no_units_says_so(u):
    start = {"x0": [1.0, 2.0] * u.m, "v0": [0.0, 0.0] * u.m / u.s}
    with pytest.raises(ArgumentError, match=r"x0=.* it has a unit, which would be lost: give plain numbers"):
        kd.solve_ensemble(lambda x: -x, (0.0, 1.0), **start, step=0.1)
    with pytest.raises(ArgumentError, match=r"t_span=.* it has a unit, which would be lost: give plain numbers"):
        kd.analysis.lyapunov_exponent(lambda x: -x, (0 * u.s, 1 * u.s), **start, step=0.1)
