"""Impacts drawn at random: no energy is gained, momentum is kept, nothing is passed through, and all comes to an end."""

import numpy as np
import pytest

import kickdrift as kd

G = 9.81


def gained(energy):
    return (energy - np.minimum.accumulate(energy)).max()


@pytest.mark.parametrize("seed", range(12))
def test_blocks_and_balls_on_slopes(seed):
    random = np.random.default_rng(seed)
    angle, friction, restitution = random.uniform(0, 1.4), random.choice([0, 0.1, 0.3, 0.7, 1.2]), random.random()
    step, method = random.choice([0.003, 0.01, 0.03]), random.choice(["velocity-verlet", "position-verlet", "dop853"])
    across = np.array([np.sin(angle), np.cos(angle)])
    start, thrown = across * random.choice([0.0, 0.3]), random.normal(size=2) * random.choice([0.0, 1.0])
    slope = kd.Impacts(lambda x: across[0] * x[0] + across[1] * x[1], restitution=restitution, friction=friction)
    sol = kd.solve(
        lambda x: np.array([0.0, -9.81]), (0, 3.0), start, thrown, step=step, method=str(method), impacts=slope
    )
    energy, size = (sol.v**2).sum(1) / 2 + G * sol.x[:, 1], 1 + np.abs(sol.x).max()
    assert sol.success
    assert gained(energy) < 1e-9 * (1 + np.abs(energy).max())
    assert (sol.x @ across).min() > -1e-11 * size
    assert (sol(random.uniform(0, 3.0, 40)).x @ across).min() > -1e-10 * size
    if restitution < 0.9 and friction > 1.01 * np.tan(angle) and not thrown.any():
        assert np.hypot(*sol.v[-1]) < 1e-12


@pytest.mark.parametrize("seed", range(12))
def test_disks_between_walls_and_free(seed):
    random = np.random.default_rng(seed)
    count, restitution = int(random.integers(2, 7)), float(random.choice([0.0, 0.3, 0.7, 1.0]))
    weight, walls, step = random.choice([0.0, 9.81]), seed % 3 > 0, float(random.choice([0.005, 0.02]))
    radii, masses = random.uniform(0.2, 0.4, count), random.uniform(0.3, 3.0, count)
    grid = np.stack(np.meshgrid(range(3), range(3)), -1).reshape(-1, 2)[:count]
    start, thrown = grid + random.uniform(-0.05, 0.05, (count, 2)), random.normal(size=(count, 2))
    pairs = kd.sphere_gaps(radii)

    def in_a_box(x):
        n = len(x)
        out = np.empty(4 * n + n * (n - 1) // 2)
        for i in range(n):
            out[4 * i], out[4 * i + 1] = x[i, 0] + 0.6 - radii[i], 2.7 - x[i, 0] - radii[i]
            out[4 * i + 2], out[4 * i + 3] = x[i, 1] + 0.6 - radii[i], 2.7 - x[i, 1] - radii[i]
        row = 4 * n
        for i in range(n):
            for j in range(i):
                out[row] = np.sqrt((x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2) - radii[i] - radii[j]
                row += 1
        return out

    def fall(x):
        out = np.zeros_like(x)
        out[:, 1] = -weight
        return out

    gaps = in_a_box if walls else pairs
    bounds = kd.Impacts(gaps, restitution=restitution, mass=masses)
    sol = kd.solve(fall, (0, 3.0), start, thrown, step=step, method="velocity-verlet", impacts=bounds)
    kinetic = ((sol.v**2).sum(2) / 2 * masses).sum(1)
    energy = kinetic + weight * (sol.x[:, :, 1] * masses).sum(1)
    assert sol.success
    assert gained(energy) < (1e-9 if restitution == 1.0 or weight == 0.0 else 50 * step**2) * (1 + kinetic.max())
    assert min(gaps(x).min() for x in sol.x) > -1e-9
    assert min(gaps(x).min() for x in sol(random.uniform(0, 3.0, 20)).x) > -1e-9
    if not walls:
        momentum = (sol.v * masses[:, None]).sum(1) + np.outer(sol.t, [0.0, weight * masses.sum()])
        assert np.abs(momentum - momentum[0]).max() < 1e-10 * (1 + np.abs(momentum).max())


@pytest.mark.parametrize("seed", range(8))
def test_beads_on_wires(seed):
    random = np.random.default_rng(seed)
    waves, phases = random.normal(size=4) * [0.5, 0.4, 0.3, 0.2], random.uniform(0, 6, 4)
    friction, restitution = float(random.choice([0.0, 0.2, 0.8])), random.random()

    def gap(x):
        height = 0.0
        for k in range(4):
            height += waves[k] * np.sin((k + 1) * 0.7 * x[0] + phases[k])
        return x[1] - height

    start = np.array([random.uniform(-2, 2), 0.0])
    start[1] = random.choice([0.0, 0.5]) - gap(start)
    wire = kd.Impacts(gap, restitution=restitution, friction=friction)
    gains = []
    for step in (0.01, 0.0025):
        sol = kd.solve(
            lambda x: np.array([0.0, -9.81]), (0, 4.0), start, [0, 0], step=step, method="velocity-verlet", impacts=wire
        )
        assert sol.success
        assert min(gap(x) for x in sol.x) > -1e-10
        assert min(gap(x) for x in sol(random.uniform(0, 4.0, 40)).x) > -1e-10
        gains.append(gained((sol.v**2).sum(1) / 2 + G * sol.x[:, 1]))
    assert gains[1] < 0.08 * gains[0] + 1e-5  # a sixteenth, of second order


@pytest.mark.parametrize("seed", range(8))
def test_walls_that_shake(seed):
    random = np.random.default_rng(seed)
    width, rate, restitution = random.uniform(0.05, 0.5), random.uniform(0.5, 20.0), random.uniform(0, 0.9)
    wall = kd.Impacts(lambda t, x: x - width * np.sin(rate * t), restitution=restitution)
    sol = kd.solve(lambda x: -9.81, (0, 5.0), width + 0.1, 0.0, step=0.01, method="velocity-verlet", impacts=wall)
    assert sol.success
    assert (sol.x - width * np.sin(rate * sol.t)).min() > -1e-10
    assert sol.n_rejected < 50_000


@pytest.mark.parametrize("seed", range(6))
def test_rough_floors_that_shake(seed):
    """A body stays where it lies: the speed of a floor is no slip along it."""
    random = np.random.default_rng(seed)
    height, rate, friction, place = 0.05, random.uniform(0.5, 4.0), random.uniform(0.1, 1.5), random.normal()
    floor = kd.Impacts(lambda t, x: x[1] - height * np.sin(rate * t), restitution=0.0, friction=friction)
    sol = kd.solve(
        lambda x: np.array([0.0, -9.81]), (0, 10.0), [place, 0.0], [0, height * rate],
        step=random.choice([0.01, 0.05]), method="velocity-verlet", impacts=floor,
    )  # fmt: skip
    assert sol.success
    assert (sol.x[:, 0] == place).all()
    np.testing.assert_allclose(sol.x[:, 1], height * np.sin(rate * sol.t), rtol=0, atol=1e-14)
    np.testing.assert_allclose(sol.v, np.outer(np.cos(rate * sol.t), [0, height * rate]), rtol=0, atol=1e-9)
