"""Energy on the Henon-Heiles problem: what each method reaches at its cost, and that it does not drift."""

import numpy as np
import pytest

import kickdrift as kd


def henon_heiles(x, out):
    out[0] = -x[0] - 2 * x[0] * x[1]
    out[1] = -x[1] - x[0] * x[0] + x[1] * x[1]


def energy(x, v):
    kinetic = 0.5 * (v[..., 0] ** 2 + v[..., 1] ** 2)
    q0, q1 = x[..., 0], x[..., 1]
    return kinetic + 0.5 * (q0**2 + q1**2) + q0**2 * q1 - q1**3 / 3


def errors(method, step, end, **options):
    run = kd.solve(henon_heiles, (0.0, end), [0.1, 0.0], [0.0, 0.5], step=step, method=method, **options)
    assert run.success
    return run, energy(run.x, run.v) - energy(run.x[0], run.v[0])


# Published: (0.1, 0), (0, 0.5), T = 1000, largest error of the energy at these costs.
TABLE = [
    ("velocity-verlet", 0.025, 40_000, 2.4e-5),
    ("forest-ruth-4", 0.1, 30_000, 3.7e-6),
    ("blanes-moan-srkn6b", 0.2, 30_000, 7.4e-9),
    ("yoshida-6", 0.2, 35_000, 2.7e-7),
    ("blanes-moan-s10", 0.4, 25_000, 2.0e-8),
    ("blanes-moan-srkn11b", 0.4, 27_500, 3.2e-10),
    ("blanes-moan-srkn14a", 0.5, 28_000, 4.6e-10),
    ("kahan-li-8", 0.5, 34_000, 1.1e-8),
    ("kahan-li-8", 0.25, 68_000, 4.2e-11),
]


@pytest.mark.parametrize(("method", "step", "evaluations", "published"), TABLE)
def test_every_row_of_the_energy_table(method, step, evaluations, published):
    run, error = errors(method, step, 1000.0)
    assert evaluations <= run.n_force_evaluations <= evaluations + 1  # one at the start, where kicks are reused
    assert published / 2 < np.abs(error).max() < 2 * published


def test_a_row_of_the_energy_table_is_not_met_by_another_method():
    _, error = errors("forest-ruth-4", 0.2, 1000.0)
    assert np.abs(error).max() > 100 * 7.4e-9


def slopes_of_energy(method, steps):
    """Slopes of the energy error over 1e5 units of time, from its means in the first and the last twentieth."""
    slopes, largest = [], 0.0
    for step in steps:
        run, error = errors(method, step, 1e5, save_every=50)
        blocks = np.array_split(error, 20)
        slopes.append((blocks[-1].mean() - blocks[0].mean()) / (run.t[-1] * 0.95))
        largest = max(largest, np.abs(error).max())
    return np.array(slopes), largest


# What is left is the rounding of the forces, a random walk that is another one for every step: the scatter of slopes
# over some steps gives the error of their mean.
STEPS = (0.06, 0.058, 0.056, 0.052, 0.05, 0.046, 0.044, 0.042)


def test_kahan_li_8_with_compensated_sums_stays_at_rounding():
    slopes, largest = slopes_of_energy("kahan-li-8", STEPS)
    assert largest < 1e-14
    assert abs(slopes.mean()) < 3 * slopes.std(ddof=1) / np.sqrt(slopes.size)
    assert np.abs(slopes).max() < 1e-14 / 1e5


def test_a_method_that_is_not_symplectic_drifts():
    slopes, largest = slopes_of_energy("runge-kutta-4", (0.052, 0.05, 0.046))
    assert largest > 1e-7
    assert abs(slopes.mean()) > 3 * slopes.std(ddof=1) / np.sqrt(slopes.size)


def test_without_compensated_sums_it_does_not_stay_at_rounding():
    _, error = errors("kahan-li-8", 0.05, 1e5, save_every=50, compensated=False)
    assert np.abs(error).max() > 2e-14
