"""Charges in electric and magnetic fields: Boris' method, exact rotations, and the words of order 4 and 6."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.analysis.one_step import take_step
from kickdrift.core.errors import ArgumentError, MethodMismatchError
from kickdrift.engine.flows import magnetic
from kickdrift.methods import Kind, Letter, Method, Tableau, blanes_moan, word
from kickdrift.methods.three_parts import in_three

BORIS, EXACT, FOURTH, SIXTH = "boris", "he-sun-liu-qin-2", "blanes-moan-gyration-4", "blanes-moan-gyration-6"
METHODS = (BORIS, EXACT, FOURTH, SIXTH)
RK4 = Method(
    name="rk4",
    order=4,
    word=word((Letter.RUNGE_KUTTA, 1)),
    symmetric=False,
    kind=Kind.FIRST_ORDER,
    source="Kutta (1901)",
    tableau=lambda: Tableau(
        a=[[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]], b=[1 / 6, 1 / 3, 1 / 3, 1 / 6]
    ),
)


def run(problem, t_span, x0, v0, step, method, **options):
    return kd.solve(problem, t_span, x0, v0, step=step, method=method, **{"compile": False} | options)


# Uniform fields, where everything is known.

AXIS = np.array([2.0, -1.0, 2.0]) / 3
OMEGA = 1.25  # of a field of 0.5 with a charge to mass of 2.5
GYRATION = kd.ChargedParticle(2.5, lambda x: 0.5 * AXIS)
ACROSS = np.array([1.0, 2.0, 0.0]) / math.sqrt(5)  # at right angles to the axis


def circle(sol):
    """Radii of the motion across the axis, and the angle of the first step."""
    centre = sol.x.mean(axis=0)
    out = sol.x - centre - np.outer((sol.x - centre) @ AXIS, AXIS)
    radii = np.linalg.norm(out, axis=1)
    return radii, 2 * math.asin(np.linalg.norm(out[1] - out[0]) / (2 * radii[0]))


@pytest.mark.parametrize("n", [7, 12, 40])
def test_boris_has_the_exact_radius_and_a_known_phase_error(n):
    # A step that turns by 2 pi / n closes the circle after n of them.
    step = 2 * math.tan(math.pi / n) / OMEGA
    sol = run(GYRATION, (0.0, step * (n - 1)), np.zeros(3), ACROSS, step, BORIS)
    radii, turn = circle(sol)
    assert radii == pytest.approx(1 / OMEGA, rel=1e-13)
    assert turn == pytest.approx(2 * math.atan(OMEGA * step / 2), rel=1e-12)
    assert abs(turn - OMEGA * step) > 1e-4


@pytest.mark.parametrize("n", [7, 12, 40])
def test_exact_rotation_has_the_exact_phase_and_a_known_error_of_the_radius(n):
    step = 2 * math.pi / n / OMEGA
    sol = run(GYRATION, (0.0, step * (n - 1)), np.zeros(3), ACROSS, step, EXACT)
    radii, turn = circle(sol)
    assert turn == pytest.approx(2 * math.pi / n, rel=1e-12)
    assert radii == pytest.approx(math.pi / n / math.tan(math.pi / n) / OMEGA, rel=1e-13)
    assert abs(radii * OMEGA - 1).min() > 0.001


def test_charges_turn_clockwise_about_the_field():
    up = kd.ChargedParticle(1.0, lambda x: np.array([0.0, 0.0, 1.0]))
    for method in METHODS:
        sol = run(up, (0.0, math.pi / 2), [0.0, 0.0, 0.0], [1.0, 0.0, 0.3], 0.001, method, compile=True)
        assert np.allclose(sol.v[-1], [0.0, -1.0, 0.3], atol=1e-6)
        assert np.allclose(sol.x[-1], [1.0, -1.0, 0.3 * math.pi / 2], atol=1e-6)


def test_the_drift_across_electric_and_magnetic_fields():
    b, e = np.array([0.0, 0.3, 1.2]), np.array([0.5, 0.8, -0.2])
    drift = np.cross(e, b) / (b @ b)
    problem = kd.ChargedParticle(-1.0, lambda x: b, lambda x: e)
    w, step = math.sqrt(b @ b), 0.9
    e_along = (e @ b) / (b @ b) * b
    for method, factor in ((BORIS, 1.0), (EXACT, w * step / 2 / math.tan(w * step / 2))):
        sol = run(problem, (0.0, 20 * step), np.zeros(3), factor * drift, step, method)
        across = sol.v + np.outer(sol.t, e_along)  # what is left beside the acceleration along B
        assert np.allclose(across, factor * drift, rtol=0, atol=1e-13)
    assert abs(factor - 1) > 0.05


@pytest.mark.parametrize("method", METHODS)
def test_a_magnetic_field_does_no_work(method):
    bottle = kd.ChargedParticle(10.0, lambda x: np.array([-x[0] * x[2], -x[1] * x[2], 1 + x[2] ** 2]))
    sol = run(bottle, (0.0, 60.0), [0.1, 0.0, 0.0], [0.1, 0.4, 0.3], 0.03, method, compile=True)
    assert abs(np.linalg.norm(sol.v, axis=1) / np.linalg.norm(sol.v[0]) - 1).max() < 1e-14
    # The mirrors hold it: it turns where the field is |v|^2 / v_across^2 = 26/17 times as strong, z^2 = 9/17.
    assert abs(sol.x[:, 2]).max() == pytest.approx(math.sqrt(9 / 17), rel=0.05)


# A field of He, Sun, Liu and Qin, J. Comput. Phys. 281, 135 (2015), section 4.1: E = 0.01 (x, y, 0) / R^3, B = R e_z.


def radial_b(x, out):
    out[0] = out[1] = 0.0
    out[2] = math.sqrt(x[0] * x[0] + x[1] * x[1])


def radial_e(x, out):
    r = math.sqrt(x[0] * x[0] + x[1] * x[1])
    out[0], out[1], out[2] = 0.01 * x[0] / r**3, 0.01 * x[1] / r**3, 0.0


def energy(x, v):
    return 0.5 * (v[0] ** 2 + v[1] ** 2 + v[2] ** 2) + 0.01 / math.sqrt(x[0] * x[0] + x[1] * x[1])


RADIAL = kd.ChargedParticle(1.0, radial_b, radial_e, energy=energy)


def a_million_steps(method):
    """Relative energy errors, distances of the gyro-centre from the axis, and the runs's own record."""
    sol = run(
        RADIAL, (0.0, 1e5 * math.pi), [0, -1, 0], [0.1, 0.01, 0], math.pi / 10, method, save_every=7, compile=True
    )
    r = np.linalg.norm(sol.x[:, :2], axis=1)
    centre = sol.x + np.cross(sol.v, [0.0, 0.0, 1.0]) / r[:, None]
    return sol.energy / sol.energy[0] - 1, np.linalg.norm(centre[:, :2], axis=1), sol


def drift(values):
    """Change of the trend over the run, and its standard error from the means of 50 blocks."""
    means = np.array([block.mean() for block in np.array_split(values, 50)])
    place = np.linspace(-0.5, 0.5, 50)
    slope = place @ means / (place @ place)
    return slope, math.sqrt(((means - means.mean() - slope * place) ** 2).sum() / 48 / (place @ place))


# Measured: 2.34e-4 for both of order 2, 9.4e-8 and 3.2e-10.
@pytest.mark.parametrize(("method", "most"), [(BORIS, 2.4e-4), (EXACT, 2.4e-4), (FOURTH, 1e-7), (SIXTH, 4e-10)])
def test_energy_and_gyro_centre_stay_over_a_million_steps_in_a_field_that_is_not_uniform(method, most):
    errors, radius, sol = a_million_steps(method)
    assert sol.success
    assert sol.n_steps == 1_000_000
    assert abs(errors).max() < most
    for values in (errors, radius):
        tenths = [np.ptp(block) for block in np.array_split(values, 10)]
        assert max(tenths) < 1.001 * min(tenths)  # what it oscillates by does not change
        change, uncertainty = drift(values)
        assert abs(change) < max(4 * uncertainty, 1e-3 * tenths[0])


def test_other_methods_lose_the_energy():
    errors, radius, _ = a_million_steps(RK4)
    assert errors[-1] < -0.3
    assert abs(drift(radius)[0]) > 1e-4
    gone = run(RADIAL, (0.0, 50.0), [0, -1, 0], [0.1, 0.01, 0], math.pi / 10, "kick-drift")
    assert not gone.success


# Fields that vary in space and time.


def wild_b(t, x):
    return np.array([0.2 * x[0] * np.sin(t) + 0.1, 0.3 * x[1], 1 + 0.5 * x[0] ** 2 + 0.3 * np.cos(2 * t)])


def wild_e(t, x):
    return np.array([-x[0] + 0.2 * np.cos(t), 0.3 * x[1] * x[0], -0.5 * x[2] ** 3])


WILD = kd.ChargedParticle(1.3, wild_b, wild_e)
START = np.array([0.5, 0.2, -0.3]), np.array([0.1, 0.7, 0.4])
STEPS = {1: (0.004, 0.002), 2: (0.05, 0.025), 4: (0.12, 0.06), 6: (0.25, 0.125)}


def observed(method, order):
    return kd.analysis.observed_order(WILD, method, (0.0, 6.0), STEPS[order], *START, compile=False).order


@pytest.mark.parametrize(("method", "order"), [(BORIS, 2), (EXACT, 2), (FOURTH, 4), (SIXTH, 6)])
def test_every_word_has_its_order_where_fields_vary_in_space_and_time(method, order):
    assert observed(method, order) == pytest.approx(order, abs=0.1)


def test_what_has_another_order_does_not_pass():
    assert observed("kick-drift", 1) == pytest.approx(1, abs=0.1)
    assert abs(observed("kick-drift", 2) - 2) > 0.1
    assert abs(observed(BORIS, 4) - 4) > 0.1
    assert abs(observed(FOURTH, 6) - 6) > 0.1


def test_boris_turns_are_no_flow_and_cannot_be_merged():
    two_parts = next(method.word for method in blanes_moan.METHODS if method.name == "blanes-moan-s6")
    merged = in_three(two_parts, Letter.DRIFT, Letter.KICK, Letter.BORIS_ROTATE)
    wrong = replace(kd.methods.get(FOURTH), name="wrong", word=merged)
    assert observed(wrong, 4) == pytest.approx(2, abs=0.3)


def determinant(method, step):
    """Of the Jacobian of one step, by central differences of order four."""
    y = np.concatenate(START)
    image = lambda y: np.concatenate(take_step(WILD, method, step, y[:3], y[3:], 0.7))  # noqa: E731
    columns = [8 * (image(y + e) - image(y - e)) - (image(y + 2 * e) - image(y - 2 * e)) for e in 2e-3 * np.eye(6)]
    return np.linalg.det(np.column_stack(columns) / 24e-3)


@pytest.mark.parametrize("method", METHODS)
def test_volume_is_preserved(method):
    assert determinant(method, 0.4) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("method", ["kick-drift", RK4], ids=["kick-drift", "rk4"])
def test_other_methods_lose_volume(method):
    assert abs(determinant(method, 0.4) - 1) > 1e-4


@pytest.mark.parametrize("method", METHODS)
def test_a_run_back_returns(method):
    there = run(WILD, (0.0, 12.0), *START, 0.1, method)
    back = run(WILD, (12.0, 0.0), there.x[-1], there.v[-1], 0.1, method)
    assert np.allclose(back.x[-1], START[0], rtol=0, atol=1e-13)
    assert np.allclose(back.v[-1], START[1], rtol=0, atol=1e-13)


def test_a_run_back_of_an_asymmetric_method_does_not():
    there = run(WILD, (0.0, 12.0), *START, 0.1, "kick-drift")
    back = run(WILD, (12.0, 0.0), there.x[-1], there.v[-1], 0.1, "kick-drift")
    assert abs(back.x[-1] - START[0]).max() > 1e-3


# States, charges, and what is refused.


def test_particles_with_charges_of_their_own():
    charges = [1.3, -0.5, 0.0]
    field = lambda x: np.stack([0.1 * x[..., 1], 0.2 + 0 * x[..., 0], 1 + x[..., 0] ** 2], axis=-1)  # noqa: E731
    x0, v0 = np.arange(9).reshape(3, 3) / 10, np.array([[0.1, 0.2, 0.3], [0.3, -0.1, 0.2], [0.1, 0.1, -0.2]])
    for method in (BORIS, FOURTH):
        together = run(kd.ChargedParticle(charges, field), (0.0, 3.0), x0, v0, 0.1, method)
        for i, charge in enumerate(charges):
            alone = run(kd.ChargedParticle(charge, field), (0.0, 3.0), x0[i], v0[i], 0.1, method)
            assert np.array_equal(together.x[:, i], alone.x)
        assert np.allclose(together.x[-1, 2], x0[2] + 3 * v0[2], rtol=0, atol=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_a_planar_motion_stays_in_its_plane(method):
    planar = kd.ChargedParticle(1.0, radial_b, radial_e)
    sol = run(planar, (0.0, 30.0), [0, -1, 0], [0.1, 0.01, 0], 0.1, method)
    assert not sol.x[:, 2].any()
    assert not sol.v[:, 2].any()


def smooth_b(t, x, out):  # products alone: powers and cosines are others in NumPy than in compiled code
    out[0], out[1], out[2] = 0.1 * x[1] + 0.2 * t, -0.3 * x[2], 1.0 + x[0] * x[0]


def smooth_e(x, out):
    out[0], out[1], out[2] = -x[0], 0.1 * x[0] * x[1], -0.5 * x[2]


@pytest.mark.parametrize("method", [BORIS, FOURTH])
def test_compiled_and_interpreted_give_the_same_bits(method):
    fields = kd.ChargedParticle(1.3, smooth_b, smooth_e)
    runs = [run(fields, (0.0, 5.0), *START, 0.1, method, compile=compile_) for compile_ in (True, False)]
    assert np.array_equal(runs[0].x, runs[1].x)
    assert np.array_equal(runs[0].v, runs[1].v)


def test_without_a_field_it_goes_straight_on():
    nothing = kd.ChargedParticle(1.0, lambda x: 0 * x)
    for method in (BORIS, EXACT):
        sol = run(nothing, (0.0, 1.0), [0.0, 0.0, 0.0], [1.0, 2.0, 3.0], 0.25, method)
        assert sol.v.tolist() == [[1.0, 2.0, 3.0]] * 5
        assert sol.x[-1].tolist() == [1.0, 2.0, 3.0]


def test_a_field_that_is_not_a_number_ends_the_run():
    torn = kd.ChargedParticle(1.0, lambda t, x: np.array([0.0, 0.0, 1.0 if t < 0.5 else np.nan]))
    for method in (BORIS, EXACT):
        sol = run(torn, (0.0, 1.0), [0.0, 0.0, 0.0], [1.0, 2.0, 3.0], 0.1, method)
        assert sol.status is kd.Outcome.NOT_FINITE
        assert sol.n_steps == 5


@pytest.mark.parametrize("kernel", [magnetic.turn, magnetic.boris_turn])
def test_bodies_of_the_kernels(kernel):
    v, w = np.array([1.0, -2.0, 0.5, 3.0, 1.0, 2.0]), np.array([0.3, 2.0, -1.0, 0.0, 0.0, 0.0])
    compiled, body = w.copy(), w.copy()
    kernel(0.7, v, compiled)
    kernel.py_func(0.7, v, body)
    assert np.array_equal(compiled, body)
    turned = v + body
    assert np.linalg.norm(turned[:3]) == pytest.approx(np.linalg.norm(v[:3]), rel=1e-15)
    assert turned[:3] @ w[:3] == pytest.approx(v[:3] @ w[:3], rel=1e-15)
    assert turned[3:].tolist() == [3.0, 1.0, 2.0]


@pytest.mark.parametrize(
    ("charge", "shape", "sentence"),
    [
        (1.0, (2,), "need \\(3,\\) or \\(N, 3\\)"),
        (1.0, (), "third component"),
        (1.0, (2, 2, 3), "need \\(3,\\)"),
        ([1.0, 2.0], (3, 3), "does not fit states of shape"),
        ([1.0, 2.0], (3,), "does not fit"),
        ("e", (3,), "charge_to_mass='e' does not fit"),
        (math.nan, (3,), "must be finite"),
    ],
)
def test_refusals(charge, shape, sentence):
    problem = kd.ChargedParticle(charge, lambda x: 0 * x)
    with pytest.raises(ArgumentError, match=sentence):
        run(problem, (0, 1), np.zeros(shape), np.zeros(shape), 0.1, BORIS)


def test_fields_do_not_depend_on_the_velocity():
    with pytest.raises(ArgumentError, match="name them t, x, params, out"):
        run(kd.ChargedParticle(1.0, lambda x, v: v), (0, 1), np.zeros(3), np.zeros(3), 0.1, BORIS)


def test_methods_that_do_not_fit_are_refused():
    with pytest.raises(MethodMismatchError, match="use 'boris'"):
        run(WILD, (0, 1), *START, 0.1, "velocity-verlet")
    with pytest.raises(MethodMismatchError, match="charges in electric and magnetic fields"):
        kd.solve(lambda x: -x, (0, 1), 0.0, 0.0, step=0.1, method=BORIS, compile=False)


@pytest.mark.parametrize("field", [lambda x: 2.0, lambda x: np.ones((3, 1)), lambda x: np.ones(2)])
@pytest.mark.parametrize("role", ["magnetic_field", "electric_field"])
def test_a_field_that_is_no_vector_is_refused(field, role):
    fields = {"magnetic_field": lambda x: np.array([0.0, 0.0, 1.0]), role: field}
    with pytest.raises(ArgumentError, match=f"{role} returns an array of shape"):
        kd.solve(
            *(kd.ChargedParticle(1.0, **fields), (0.0, 1.0), np.zeros((3, 3)), np.ones((3, 3))),
            step=0.1,
            method="boris",
            compile=False,
        )
