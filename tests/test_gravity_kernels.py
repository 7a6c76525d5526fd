"""Direct-summation gravity kernels against a one-sided sum in extended precision."""

from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray
from vector_instructions import needs_wide_vectors, packed

import kickdrift as kd
from kickdrift.systems import gravity, massless

Floats = NDArray[np.float64]
Kernel = Any  # a compiled function, with its Python body as py_func

KERNELS = [gravity.add_gravity_pairwise, gravity.add_gravity_tiled, gravity.add_gravity_threaded]
TILED = KERNELS[1:]
SIZES = [0, 1, 2, 3, 5, 63, 64, 65, *range(127, 201), 255, 256, 257, 383, 384, 385, 1000]

# Rounding of a sum of up to 1000 terms, relative to the sum of their magnitudes: up to 3.3e-15 was seen.
ROUNDING = 5e-15


def bodies(n: int, softening: float = 0.0, scale: float = 1.0) -> tuple[Floats, Floats]:
    """Random positions and params of n bodies."""
    rng = np.random.default_rng(n)
    return scale * rng.normal(size=3 * n), np.concatenate([[softening**2], rng.uniform(0.5, 1.5, n)])


def one_sided(x: Floats, params: Floats) -> tuple[NDArray[np.longdouble], NDArray[np.longdouble]]:
    """Accelerations in extended precision, and for each component the sum of the magnitudes of its terms."""
    position, gm = x.reshape(-1, 3).astype(np.longdouble), params[1:].astype(np.longdouble)
    acceleration, magnitude = np.zeros_like(position), np.zeros_like(position)
    for i in range(len(gm)):
        others = np.arange(len(gm)) != i
        d = position[others] - position[i]
        r2 = (d**2).sum(axis=1) + np.longdouble(params[0])
        terms = gm[others, None] * d / (r2 * np.sqrt(r2))[:, None]
        acceleration[i], magnitude[i] = terms.sum(axis=0), np.abs(terms).sum(axis=0)
    return acceleration, magnitude


def largest_errors(kernels: list[Kernel], x: Floats, params: Floats) -> dict[str, float]:
    """Largest errors of a component, relative to the magnitudes of its terms."""
    reference, magnitude = one_sided(x, params)
    size = np.where(magnitude > 0, magnitude, 1)
    errors = {kernel: np.abs(evaluated(kernel, x, params).reshape(-1, 3) - reference) / size for kernel in kernels}
    return {kernel.__name__: float(np.max(error, initial=0.0)) for kernel, error in errors.items()}


def evaluated(kernel: Kernel, x: Floats, params: Floats) -> Floats:
    into = np.zeros_like(x)
    kernel(1.0, x, params, into)
    return into


@pytest.mark.parametrize("softening", [0.0, 0.1])
def test_accelerations_are_the_one_sided_sum(softening: float) -> None:
    for n in SIZES:
        errors = largest_errors(KERNELS, *bodies(n, softening))
        assert max(errors.values()) < ROUNDING, (n, errors)


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
def test_the_threshold_sees_one_mass_off_in_its_twelfth_digit(kernel: Kernel) -> None:
    x, params = bodies(130)
    params_off = params.copy()
    params_off[7] *= 1 + 1e-12
    reference, magnitude = one_sided(x, params_off)
    error = np.abs(evaluated(kernel, x, params).reshape(-1, 3) - reference) / magnitude
    assert error.max() > ROUNDING


@pytest.mark.parametrize("scale", [1e-90, 1e-30, 1e30, 1e90])
def test_accelerations_at_any_scale(scale: float) -> None:
    assert max(largest_errors(TILED, *bodies(300, scale=scale)).values()) < ROUNDING


def test_inverse_cube_to_rounding_over_all_of_float64() -> None:
    r2 = np.float64(10) ** np.random.default_rng(0).uniform(-204, 204, 20_000)
    # One octave pair densely: the seed's error repeats with every factor of four.
    for value in np.concatenate([r2, np.linspace(1, 4, 20_001)]):
        exact = np.longdouble(value) ** np.longdouble(-1.5)
        assert abs(gravity._inverse_cube(value) - exact) < 1e-15 * exact
    assert gravity._inverse_cube.py_func(np.float64(2.0)) == pytest.approx(2**-1.5, rel=1e-15)


@pytest.mark.parametrize("r2", [0.0, np.inf, np.nan])
def test_inverse_cube_hides_nothing(r2: float) -> None:
    assert not np.isfinite(gravity._inverse_cube(r2))


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
def test_kick_adds_h_times_the_acceleration(kernel: Kernel) -> None:
    x, params = bodies(150, 0.05)
    v = np.random.default_rng(1).normal(size=x.size)
    kicked = v.copy()
    kernel(-0.25, x, params, kicked)
    np.testing.assert_allclose(
        kicked, v - 0.25 * evaluated(kernel, x, params), rtol=0, atol=1e-13 * np.abs(kicked).max()
    )


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
@pytest.mark.parametrize("n", [2, 5, 129, 1000])
def test_no_net_force(kernel: Kernel, n: int) -> None:
    x, params = bodies(n)
    forces = params[1:, None] * evaluated(kernel, x, params).reshape(-1, 3)
    net = np.abs(forces.sum(axis=0)).max()
    assert net < 1e-15 * np.sqrt(n) * np.abs(forces).sum()
    # One force less is seen.
    assert np.abs(forces[1:].sum(axis=0)).max() > 1e-15 * np.sqrt(n) * np.abs(forces).sum()


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
@pytest.mark.parametrize("pair", [(0, 1), (3, 12), (0, 128), (1, 128), (130, 257), (131, 299)])
def test_coincident_bodies_are_not_finite_unless_softened(kernel: Kernel, pair: tuple[int, int]) -> None:
    x, params = bodies(300)
    first, second = pair
    x[3 * second : 3 * second + 3] = x[3 * first : 3 * first + 3]
    a = evaluated(kernel, x, params).reshape(-1, 3)
    assert not np.isfinite(a[first]).any()
    assert not np.isfinite(a[second]).any()
    assert np.isfinite(np.delete(a, pair, axis=0)).all()
    params[0] = 0.01
    assert np.isfinite(evaluated(kernel, x, params)).all()


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
def test_not_a_number_is_seen(kernel: Kernel) -> None:
    x, params = bodies(300)
    x[3 * 140] = np.nan
    assert not np.isfinite(evaluated(kernel, x, params)).any(where=np.arange(x.size) % 3 == 0)


@pytest.mark.parametrize("n", [1, 100, 128, 129, 256, 257, 300, 512, 641, 1000, 1500, 2049, 5003])
def test_same_bits_for_any_number_of_threads(n: int) -> None:
    x, params = bodies(n)
    serial = evaluated(gravity.add_gravity_tiled, x, params)
    available = numba.get_num_threads()
    try:
        for threads in range(1, available + 1):
            numba.set_num_threads(threads)
            np.testing.assert_array_equal(evaluated(gravity.add_gravity_threaded, x, params), serial)
    finally:
        numba.set_num_threads(available)


def test_another_order_of_the_sums_has_other_bits() -> None:
    x, params = bodies(641)
    backwards = evaluated(
        gravity.add_gravity_tiled, x.reshape(-1, 3)[::-1].ravel().copy(), np.append(params[0], params[:0:-1])
    )
    backwards = backwards.reshape(-1, 3)[::-1].ravel()
    serial = evaluated(gravity.add_gravity_tiled, x, params)
    assert (backwards != serial).any()
    np.testing.assert_allclose(backwards, serial, rtol=0, atol=1e-13 * np.abs(serial).max())


@pytest.mark.parametrize("n", [0, 1, 128, 129, 300, 600, 1000, 2048, 2049, 5000])
def test_every_two_tiles_meet_once_and_groups_share_no_sums(n: int, monkeypatch: pytest.MonkeyPatch) -> None:
    met, alone = [], []

    def between(a: Floats, b: Floats, sums_a: Floats, sums_b: Floats, *sizes: float) -> None:
        met.append({int(a[0]), int(b[0])})
        assert np.shares_memory(sums_a, sums[group, 0])
        assert np.shares_memory(sums_b, sums[group])
        assert not np.shares_memory(sums_a, sums_b)

    monkeypatch.setattr(gravity, "_between_tiles", between)
    monkeypatch.setattr(gravity, "_within_tile", lambda a, *others: alone.append(int(a[0])))
    x, params = bodies(n)
    tiles, sums = gravity._packed(x, params)
    tiles[:, 0] = np.arange(len(tiles))
    ahead = [gravity._groups_ahead(group, len(sums)) for group in range(len(sums))]
    for group in range(len(sums)):
        gravity._sum_half_ring.py_func(group, tiles, sums, params)
    count = len(tiles)
    assert sorted(map(sorted, met)) == [[i, j] for i in range(count) for j in range(i + 1, count)]
    assert sorted(alone) == list(range(count))
    # Work is even: groups meet as many others but for one, and so do the two halves of the ring, one for each thread.
    assert max(ahead) - min(ahead) <= 1
    half = len(ahead) // 2
    assert half == 0 or abs(sum(ahead[:half]) - sum(ahead[half:])) <= 1
    sizes = [gravity._members(t, count, params)[1] for t in range(count)]
    assert sum(sizes) == n
    assert max(sizes, default=0) <= gravity.TILE
    assert max(sizes, default=0) - min(sizes, default=0) < 2 * gravity._LANES


def packed_instructions(function: Kernel, *types: Any, **flags: Any) -> dict[str, int]:
    """Count packed square roots, divisions and fused multiply-adds."""
    fresh = numba.jit(**{**function.targetoptions, **flags})(function.py_func)
    fresh.compile(types)
    (assembly,) = fresh.inspect_asm().values()
    instructions = {"sqrt": "vsqrt", "div": "vdiv", "fma": r"vfn?m(?:add|sub)\d+"}
    return {name: packed(assembly, instruction) for name, instruction in instructions.items()}


@needs_wide_vectors
def test_kernels_are_vectorised() -> None:
    # Losing the vectors changes no result, only the speed.
    array, size, number = numba.float64[::1], numba.int64, numba.float64
    tile_pair = (gravity._between_tiles, array, array, array, array, size, size, number)
    self_pair = (gravity._within_tile, array, array, size, number)
    assert min(packed_instructions(*tile_pair).values()) >= 1
    assert packed_instructions(*tile_pair)["fma"] >= 20
    assert min(packed_instructions(*self_pair).values()) >= 1
    assert packed_instructions(gravity._potential, size, array, array)["sqrt"] >= 1
    assert packed_instructions(gravity.add_gravity_pairwise, number, array, array, array)["sqrt"] >= 1
    # Without leave to reorder sums there are no vectors, and the count sees it.
    assert packed_instructions(*tile_pair, fastmath=False)["sqrt"] == 0


@pytest.mark.parametrize("n", [1, 2, 5, 131, 1000])
@pytest.mark.parametrize("softening", [0.0, 0.1])
def test_invariants_in_extended_precision(n: int, softening: float) -> None:
    G = 39.5
    x, params = bodies(n, softening)
    v = np.random.default_rng(n + 1).normal(size=x.size)
    position, velocity = (a.reshape(-1, 3).astype(np.longdouble) for a in (x, v))
    m = params[1:].astype(np.longdouble) / G
    kinetic = 0.5 * (m[:, None] * velocity**2).sum()
    i, j = np.triu_indices(n, 1)
    distance = np.sqrt(((position[i] - position[j]) ** 2).sum(axis=1) + np.longdouble(params[0]))
    potential = -(G * m[i] * m[j] / distance).sum()
    for energy in (gravity.energy, gravity.energy.py_func):
        assert abs(energy(x, v, params, G) - (kinetic + potential)) < 2e-15 * (kinetic - potential)
        assert abs(energy(x, v * (1 + 1e-14), params, G) - (kinetic + potential)) < 1e-13 * (kinetic - potential)

    out = np.full(3, np.nan)
    for function, terms in (
        (gravity.momentum, m[:, None] * velocity),
        (gravity.angular_momentum, m[:, None] * np.cross(position, velocity)),
    ):
        for variant in (function, function.py_func):
            variant(x, v, params, G, out)
            assert np.abs(out - terms.sum(axis=0)).max() < 1e-15 * np.sqrt(n) * np.abs(terms).sum()


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
def test_python_bodies_say_the_same(kernel: Kernel, monkeypatch: pytest.MonkeyPatch) -> None:
    x, params = bodies(11, 0.01)
    compiled = evaluated(kernel, x, params)
    for name, function in vars(gravity).copy().items():
        if name.startswith("_") and hasattr(function, "py_func"):
            monkeypatch.setattr(gravity, name, function.py_func)
    np.testing.assert_allclose(evaluated(kernel.py_func, x, params), compiled, rtol=1e-13)


def test_python_body_of_two_tiles_says_the_same() -> None:
    x, params = bodies(11, 0.01)
    forces = evaluated(gravity.add_gravity_pairwise, x, params)
    a, b = np.zeros((2, gravity._TILE_SIZE))
    sums_a, sums_b = np.zeros((2, gravity._SUMS_SIZE))
    for tile, members in ((a, range(7)), (b, range(7, 11))):
        for lane, body in enumerate(members):
            tile[[gravity._X + lane, gravity._Y + lane, gravity._Z + lane]] = x[3 * body : 3 * body + 3]
            tile[gravity._GM + lane] = params[1 + body]
        tile[gravity._X + len(members) : gravity._X + 8] = gravity._FAR_AWAY
    gravity._within_tile.py_func(a, sums_a, 7, params[0])
    gravity._within_tile.py_func(b, sums_b, 4, params[0])
    gravity._between_tiles.py_func(a, b, sums_a, sums_b, 7, 4, params[0])
    lanes = [
        np.stack([sums[field : field + n] for field in (gravity._X, gravity._Y, gravity._Z)], axis=1)
        for sums, n in ((sums_a, 7), (sums_b, 4))
    ]
    np.testing.assert_allclose(np.concatenate(lanes).ravel(), forces, rtol=1e-12)


@pytest.mark.parametrize("kernel", [massless.add_gravity_of_massive, massless.add_gravity_of_massive.py_func])
@pytest.mark.parametrize(("n", "massive"), [(1, 0), (40, 0), (40, 7), (300, 1), (700, 70), (40, 40)])
def test_bodies_without_mass_are_attracted_and_do_not_attract(kernel: Kernel, n: int, massive: int) -> None:
    for softening in (0.0, 0.1):
        x, params = bodies(n, softening)
        params[1:][np.random.default_rng(3).permutation(n)[massive:]] = 0.0
        assert max(largest_errors([kernel], x, params).values()) < ROUNDING


def test_many_bodies_without_mass_are_summed_apart() -> None:
    assert massless.mostly_massless(np.append(np.ones(4), np.zeros(100)))
    assert not massless.mostly_massless(np.append(np.ones(4), np.zeros(10)))  # a loop over pairs is as fast
    assert not massless.mostly_massless(np.ones(100))
    assert massless.mostly_massless(np.append(np.ones(100), np.zeros(400)))
    assert not massless.mostly_massless(np.append(np.ones(100), np.zeros(400)), threads=True)
    assert massless.mostly_massless(np.append(np.ones(4), np.zeros(100)), threads=True)


@pytest.mark.parametrize(
    ("massive", "others", "threaded"), [(20, 0, False), (5, 95, False), (100, 0, True), (50, 150, True)]
)
def test_only_forces_that_threads_share_have_another_form_without(massive, others, threaded):
    rng = np.random.default_rng(1)
    masses = np.append(np.ones(massive), np.zeros(others))
    system = kd.systems.nbody(masses, rng.normal(size=(masses.size, 3)), np.zeros((masses.size, 3)), threads=True)
    assert (system.unthreaded is not None) == threaded
    rng = np.random.default_rng(4)
    x, v = rng.normal(size=(60, 3)), rng.normal(size=(60, 3))
    few, many = (kd.systems.nbody(np.append(np.ones(5), np.full(55, m)), x, v) for m in (0.0, 1e-300))
    assert few.acceleration is not many.acceleration
    ends = [kd.solve(system, (0.0, 0.05), step=0.01).x[-1] for system in (few, many)]
    assert np.allclose(*ends, rtol=1e-12)
