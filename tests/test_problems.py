"""Problems described by functions: what they are taken for, what they give, and what they refuse."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.methods import Kind

SPAN = {"t_span": (0.0, 1.0), "step": 0.1}
interpreted_or_compiled = pytest.mark.parametrize("compile", [False, True], ids=["interpreted", "compiled"])


def kind_of(problem, x0=1.0, v0=0.5):
    return Kind[kd.solve(problem, x0=x0, v0=v0, compile=False, **SPAN).about.kind]


# What they are taken for.


@pytest.mark.parametrize(
    ("problem", "kind"),
    [
        (lambda x: -x, Kind.NEWTONIAN),
        (lambda t, x: -x + t, Kind.NEWTONIAN),
        (lambda x, v: -x - v, Kind.VELOCITY_DEPENDENT),
        (kd.SecondOrder(lambda x: -x), Kind.NEWTONIAN),
        (kd.Newtonian(lambda x: -x), Kind.NEWTONIAN),
        (kd.Newtonian(lambda x, v: -x - v), Kind.VELOCITY_DEPENDENT),
        (kd.Separable(lambda p: p, lambda q: q), Kind.SEPARABLE),
        (kd.Hamiltonian(dHdq=lambda q, p: q, dHdp=lambda q, p: p), Kind.HAMILTONIAN),
        (kd.Hamiltonian(dHdq=lambda q: q, dHdp=lambda p, t: p), Kind.SEPARABLE),
        (kd.Partitioned(lambda x, v: v, lambda x: -x), Kind.PARTITIONED),
        (kd.Partitioned(lambda v: v, lambda x: -x), Kind.SEPARABLE),
    ],
)
def test_the_names_of_the_arguments_declare_the_kind(problem, kind):
    assert kind_of(problem) is kind


def test_first_order_equations_have_no_velocity():
    run = kd.solve(kd.FirstOrder(lambda y: -y), x0=[1.0, 2.0], method="explicit-euler", compile=False, **SPAN)
    assert run.y is run.x
    assert run.v.shape == (11, 0)
    assert Kind[run.about.kind] is Kind.FIRST_ORDER


def test_hamiltonians_have_q_and_p():
    run = kd.solve(kd.Separable(lambda p: p, lambda q: q), x0=1.0, v0=0.5, compile=False, **SPAN)
    assert run.q is run.x
    assert run.p is run.v


# What they give: the same as the plain description, or as a loop by hand.


@pytest.mark.parametrize(("shape", "compile"), [((), False), ((2,), False), ((3, 2), False), ((3, 2), True)], ids=str)
def test_every_description_of_an_oscillator_is_the_same_one(shape, compile):  # noqa: A002
    start = {"x0": np.full(shape, 0.8), "v0": np.full(shape, 0.3)}
    options = {"method": "blanes-moan-s6", "compile": compile, **start, **SPAN}
    plain = kd.solve(lambda x: -x, **options)
    others = [
        kd.Newtonian(lambda x: -2 * x, mass=2.0),
        kd.Separable(lambda p: p, lambda q: q),
        kd.Hamiltonian(dHdq=lambda q: q, dHdp=lambda p: p),
        kd.Partitioned(lambda v: v, lambda x: -x),
    ]
    for problem in others:
        run = kd.solve(problem, **options)
        assert np.array_equal(run.x, plain.x)
        assert np.array_equal(run.v, plain.v)
        assert run.x.shape == (11, *shape)


@interpreted_or_compiled
def test_writing_into_out_is_returning(compile):  # noqa: A002
    def kinetic(p, out):
        out[:] = p / np.sqrt(1 + p[0] ** 2 + p[1] ** 2)

    def potential(q, params, out):
        out[:] = params[0] * q

    options = {"x0": [1.0, 0.0], "v0": [0.0, 2.0], "args": (3.0,), "compile": compile, **SPAN}
    writing = kd.solve(kd.Separable(kinetic, potential), **options)
    returning = kd.solve(
        kd.Separable(lambda p: p / np.sqrt(1 + p[0] ** 2 + p[1] ** 2), lambda q, params: params[0] * q), **options
    )
    assert np.array_equal(writing.x, returning.x)
    assert np.array_equal(writing.v, returning.v)


@interpreted_or_compiled
@pytest.mark.parametrize("masses", [[[1.0], [4.0]], [1.0, 4.0]], ids=str)
def test_masses_are_those_of_bodies(compile, masses):  # noqa: A002
    run = kd.solve(
        kd.Newtonian(lambda x, params: -params[0] * x, mass=masses),
        x0=np.ones((2, 3)),
        v0=np.zeros((2, 3)),
        args=(2.0,),
        compile=compile,
        **SPAN,
    )
    alone = kd.solve(lambda x: -0.5 * x, x0=1.0, v0=0.0, compile=False, **SPAN)
    assert np.array_equal(run.x[:, 1, 2], alone.x)
    assert not np.array_equal(run.x[:, 0, 2], alone.x)


@settings(max_examples=30, deadline=None)
@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(0.01, 0.3))
def test_semi_implicit_euler_for_any_hamiltonian_is_the_one_by_hand(q, p, h):
    # H = p^2 (1 + q^2) / 2: p1 = p - h q p1^2 has a closed solution, the root that goes to p as h goes to 0.
    system = kd.Hamiltonian(dHdq=lambda q, p: q * p * p, dHdp=lambda q, p: p * (1 + q * q))
    discriminant = 1 + 4 * h * q * p
    if discriminant < 0.3:
        return
    run = kd.solve(system, (0.0, h), q, p, step=h, method="semi-implicit-euler", compile=False)
    p1 = 2 * p / (1 + np.sqrt(discriminant))
    assert run.p[-1] == pytest.approx(p1, rel=1e-13, abs=1e-15)
    assert run.q[-1] == pytest.approx(q + h * p1 * (1 + q * q), rel=1e-13, abs=1e-15)


def test_the_rate_of_x_sees_the_clock_of_the_kicks():
    # Two forced halves, each with its own clock: the order of a composition survives both.
    problem = kd.Separable(lambda p, t: p + np.cos(3 * t), lambda q, t: q + q**3 - np.sin(2 * t))
    ends = [
        kd.solve(problem, (0, 2), 1.0, 0.0, step=2 / n, method="blanes-moan-s6", compile=False, save_every=n)
        for n in (20, 40, 80)
    ]
    first, second = (np.hypot(a.x[-1] - b.x[-1], a.v[-1] - b.v[-1]) for a, b in pairwise(ends))
    assert np.log2(first / second) == pytest.approx(4, abs=0.15)


@interpreted_or_compiled
def test_energy_and_invariants_have_the_names_of_the_problem(compile):  # noqa: A002
    system = kd.Hamiltonian(
        dHdq=lambda q, p: q * (1 + p * p),
        dHdp=lambda q, p: p * (1 + q * q),
        energy=lambda q, p: 0.5 * (1 + q * q) * (1 + p * p),
        invariants={"twice": lambda x, v: (1 + x * x) * (1 + v * v)},
    )
    run = kd.solve(system, x0=0.5, v0=0.1, compile=compile, **SPAN)
    assert run.energy[0] == pytest.approx(0.5 * 1.25 * 1.01)
    assert np.allclose(run.invariants["twice"], 2 * run.energy)
    growing = kd.FirstOrder(lambda y: y, invariants={"sum": lambda y: y[0] + y[1]})
    run = kd.solve(growing, x0=[1.0, 2.0], method="explicit-euler", compile=compile, **SPAN)
    assert run.invariants["sum"][0] == 3.0


def test_other_solutions_are_drawn_saved_and_labelled(tmp_path):
    fish = kd.Partitioned(lambda x, v: x * (1 - v), lambda x, v: v * (x - 1))
    cycle = kd.FirstOrder(lambda y: np.array([y[1], (1 - y[0] ** 2) * y[1] - y[0]]))
    runs = [
        kd.solve(fish, x0=0.5, v0=1.0, method="implicit-verlet", compile=False, **SPAN),
        kd.solve(cycle, x0=[1.0, 0.0], method="explicit-euler", compile=False, **SPAN),
    ]
    for run in runs:
        loaded = kd.load(run.save(tmp_path / "run.npz"))
        assert np.array_equal(loaded.x, run.x)
        assert np.array_equal(loaded.v, run.v)
        assert loaded.about == run.about
        assert ("v" in run.to_xarray()) == (run.v.size > 0)
        run.plot(tmp_path / "run.png")
        assert (tmp_path / "run.png").stat().st_size > 10_000


# What they refuse.


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (kd.Separable(lambda q: q, lambda q: q), r"kinetic_gradient lambda\(q\) has arguments"),
        (kd.Separable(lambda p: p, lambda p: p), r"potential_gradient lambda\(p\) has arguments"),
        (kd.Separable(3, lambda q: q), "kinetic_gradient is 3, which is not a function"),
        (kd.Hamiltonian(dHdq=lambda y: y, dHdp=lambda p: p), r"dHdq lambda\(y\) has arguments"),
        (kd.Hamiltonian(dHdq=lambda q: np.zeros(3), dHdp=lambda p: p), "failed at the start"),
        (kd.Partitioned(lambda q: q, lambda x: x), r"x_rate lambda\(q\) has arguments"),
        (kd.Newtonian(lambda x: x, mass=0.0), r"mass=0\.0 must be positive"),
        (kd.Newtonian(lambda x: x, mass=[1.0, np.inf]), "mass=.* must be positive and finite"),
        (kd.Newtonian(lambda x: x, mass=[1.0, 2.0, 3.0]), "does not fit states of shape"),
        (kd.Newtonian(lambda x: x, mass="heavy"), "mass='heavy' does not fit"),
    ],
)
def test_what_a_description_cannot_be_is_refused(problem, reason):
    with pytest.raises(ArgumentError, match=reason):
        kd.solve(problem, x0=[1.0, 0.5], v0=[0.0, 0.0], compile=False, **SPAN)


def test_first_order_equations_refuse_a_velocity():
    with pytest.raises(ArgumentError, match="first-order equations have only x0"):
        kd.solve(kd.FirstOrder(lambda y: y), x0=1.0, v0=0.0, **SPAN)
    with pytest.raises(ArgumentError, match=r"rates lambda\(v\) has arguments"):
        kd.solve(kd.FirstOrder(lambda v: v), x0=1.0, **SPAN)


def test_as_many_masses_as_bodies_and_dimensions_are_those_of_the_bodies():
    run = kd.solve(
        kd.Newtonian(lambda x: np.ones((2, 2)), mass=[1.0, 2.0]), x0=np.zeros((2, 2)), v0=np.zeros((2, 2)), **SPAN
    )
    assert run.x[-1] == pytest.approx(np.array([[0.55, 0.55], [0.275, 0.275]]))


def test_a_problem_needs_a_start():
    with pytest.raises(ArgumentError, match="v0 is missing"):
        kd.solve(kd.Separable(lambda p: p, lambda q: q), x0=1.0, **SPAN)
