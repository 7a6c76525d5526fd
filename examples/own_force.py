"""A force of your own, with parameters: a mass on a hardening spring, driven periodically.

x'' = -k x - c x^3 + f cos(w t). The argument names declare what the force depends on: t is the time, params
are the numbers passed as ``args``.
"""

import math

import kickdrift as kd


def driven_spring(t, x, params):
    k, c, f, w = params
    return -k * x - c * x**3 + f * math.cos(w * t)


def main():
    for strength in (0.1, 0.3, 1.0):
        sol = kd.solve(
            driven_spring,
            t_span=(0.0, 200.0),
            x0=0.0,
            v0=0.0,
            args=(1.0, 0.5, strength, 1.3),
            method="velocity-verlet",
            step=0.01,
        )
        print(f"driven by {strength}: swings out to {abs(sol.x).max():.4f} ({sol.n_steps} steps)")


if __name__ == "__main__":
    main()
