"""A flag in gusts, for a long time: whether its energy stays bounded.

``python tests/flag_in_gusts.py --steps 50000`` prints for each tenth of so many steps of 1/60 s the kinetic energy of the flag,
in the mean and at most, and the speed of its fastest particle.
"""

import argparse

import numpy as np

import kickdrift as kd
from kickdrift.scenes.worlds.cloths import flag

STEP = 1 / 60


def fluttering(seed=0):
    """Return a world with a flag in gusts of 10 m/s in the mean."""
    world = flag(vertices=(24, 16), wind=0.0)
    world.add_wind(kd.gusts((10.0, 2.0, 0.0), intensity=0.4, length=3.0, seed=seed))
    return world


def energies(world, steps):
    """Kinetic energies, J, and largest speeds of particles, m/s, each ten steps."""
    rows = []
    for _ in range(steps // 10):
        world.advance(STEP, 10)
        rows.append((world.energy().kinetic, np.linalg.norm(world.cloth("flag").velocity, axis=1).max()))
    return np.array(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    world = fluttering(arguments.seed)
    for tenth in range(10):
        kinetic, speeds = energies(world, arguments.steps // 10).T
        print(
            f"{(tenth + 1) * arguments.steps // 10} steps: kinetic energy {kinetic.mean():.3g} J in the mean, "
            f"{kinetic.max():.3g} J at most; fastest particle {speeds.max():.3g} m/s"
        )


if __name__ == "__main__":
    main()
