"""The whole semi-implicit Euler method in NumPy: a planet on an ellipse.

    v += h * a(t, x, v)        a kick
    x += h * v                 a drift

The order matters: with the old velocity in the second line this is the explicit Euler method, and the planet
spirals away. kickdrift runs the same loop compiled, bit for bit (``compensated=False``).
"""

import numpy as np


def gravity(x):
    r2 = x[0] * x[0] + x[1] * x[1]
    return -x / (r2 * np.sqrt(r2))


def energy(x, v):
    return 0.5 * (v @ v) - 1.0 / np.sqrt(x @ x)


def integrate(acceleration, x, v, step, n_steps):
    x, v = np.array(x, dtype=float), np.array(v, dtype=float)
    xs, vs = [x.copy()], [v.copy()]
    for _ in range(n_steps):
        v += step * acceleration(x)  # kick
        x += step * v  # drift
        xs.append(x.copy())
        vs.append(v.copy())
    return np.array(xs), np.array(vs)


def main():
    xs, vs = integrate(gravity, x=[1.0, 0.0], v=[0.0, 1.1], step=0.01, n_steps=10_000)
    errors = [energy(x, v) - energy(xs[0], vs[0]) for x, v in zip(xs, vs, strict=True)]
    print(f"after {len(xs) - 1} steps the planet is at {xs[-1]}")
    print(f"the energy {energy(xs[0], vs[0]):.6f} was never off by more than {np.abs(errors).max():.1e}")


if __name__ == "__main__":
    main()
