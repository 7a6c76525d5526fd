"""Sticks, plates and smooth capsules that land: how much energy they gain, how much of their spin changes.

The same for thin discs and cones: how far above that at the start, and above what they had lost before, their energy rises, and
how far they sink in.

``python tests/landings.py --starts 200`` prints it for each restitution and friction, of so many random starts.
"""

import argparse

import numpy as np

from kickdrift import World
from kickdrift.core.vectors import turned

STEP = 1 / 60
RESTITUTIONS, FRICTIONS = (0.0, 0.5, 0.8, 1.0), (0.0, 0.5)
GROUNDS = ("plane", "box", "mesh")
SIZES = (
    (1, 1, 40), (1, 1, 20), (1, 1, 10), (1, 1, 5), (1, 2, 20), (1, 4, 20), (1, 1, 1), (5, 5, 1), (10, 10, 1), (20, 20, 1),
)  # fmt: skip

DISCS = (
    ("cylinder", 0.05, 0.01), ("cylinder", 0.3, 0.03), ("cone", 0.1, 0.01), ("cone", 0.2, 0.2), ("cone", 0.3, 0.03),
    ("cone", 0.3, 0.1),
)  # fmt: skip


def random_turn(rng):
    q, axis = rng.normal(size=4), rng.normal(size=3)
    return {"orientation": q, "angular_velocity": rng.uniform(0, 10) * axis / np.linalg.norm(axis)}


def axis_of(world, body):
    """Where the z axis of a body points."""
    return np.array(turned(tuple(world.orientation[body.index]), (0.0, 0.0, 1.0)))


def energies(size, restitution, friction, rng):
    """Energy of a box before it lands, and the most and the least of it until it lies or has bounced a few times."""
    surface = {"restitution": restitution, "friction": friction}
    world = World()
    world.add_plane(**surface)
    world.add_box(np.array(size) / 20, position=(0, 0, 2), **random_turn(rng), **surface)
    found = [world.energy().total]
    for _ in range(30):
        world.advance(STEP, 5)
        found.append(world.energy().total)
    return found[0], max(found), min(found)


def change_of_spin(ground, restitution, rng):
    """Change of the spin of a smooth capsule of 1:1 to 1:60 about its axis, rad/s, where it lands."""
    world, smooth = World(), {"friction": 0.0, "restitution": restitution}
    if ground == "plane":
        world.add_plane(**smooth)
    elif ground == "box":
        world.add_box((20, 20, 2), position=(0, 0, -1), static=True, **smooth)
    else:
        corners = [(-10, -10, 0), (10, -10, 0), (10, 10, 0), (-10, 10, 0)]
        world.add_mesh(corners, [(0, 1, 2), (0, 2, 3)], **smooth)
    turn = random_turn(rng)
    turn["angular_velocity"] = rng.choice([1.0, 3.0]) * turn["angular_velocity"]
    radius = 0.5 * 10.0 ** rng.uniform(-1.8, 0.0)
    capsule = world.add_capsule(radius, 1.0, position=(0, 0, 2), **smooth, **turn)
    before = axis_of(world, capsule) @ world.angular_velocity[capsule.index]
    world.advance(STEP, 150)
    return axis_of(world, capsule) @ world.angular_velocity[capsule.index] - before


def landing_disc(kind, radius, length, restitution, friction, rng):
    """Largest rise of the energy of a disc or a cone above its start, and above its minimum before, and its greatest depth, m.

    The first two are parts of the energy at the start.
    """
    surface = {"restitution": restitution, "friction": friction}
    world, base = World(), -length / 2 if kind == "cylinder" else -length / 4  # from the centre of mass
    world.add_plane(**surface)
    motion = {"velocity": 2.0 * rng.normal(size=3), "angular_velocity": 5.0 * rng.normal(size=3)}
    body = getattr(world, f"add_{kind}")(
        radius, length, position=(0, 0, 1.2), orientation=rng.normal(size=4), **surface, **motion
    )
    energy, deepest = [world.energy().total], 0.0
    for _ in range(90):
        world.advance(STEP, 1)
        energy.append(world.energy().total)
        axis = axis_of(world, body)
        low, high = base * axis[2], (base + length) * axis[2]
        rim = radius * np.sqrt(max(1.0 - axis[2] ** 2, 0.0))
        lowest = min(low - rim, high - rim if kind == "cylinder" else high) + body.position[2]
        deepest = max(deepest, -lowest)
    return max(energy) / energy[0] - 1.0, (energy - np.minimum.accumulate(energy)).max() / energy[0], deepest


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=200)
    starts = parser.parse_args().starts
    print("| restitution | friction | energy gained at most | energy lost at most |\n| --- | --- | --- | --- |")
    for restitution in RESTITUTIONS:
        for friction in FRICTIONS:
            rng = np.random.default_rng(7)
            found = np.array([energies(SIZES[k % len(SIZES)], restitution, friction, rng) for k in range(starts)])
            gained, lost = found[:, 1] / found[:, 0] - 1.0, 1.0 - found[:, 2] / found[:, 0]
            print(f"| {restitution} | {friction} | {gained.max():.1e} | {lost.max():.1e} |", flush=True)
    for ground in GROUNDS:
        for restitution in RESTITUTIONS:
            rng = np.random.default_rng(8)
            most = max(abs(change_of_spin(ground, restitution, rng)) for _ in range(starts))
            print(
                f"spin of a smooth capsule on a {ground}, e = {restitution}: changes by {most:.1e} rad/s at most",
                flush=True,
            )
    print(
        "| disc or cone | restitution | friction | above its start | > 1 % above an earlier value | at most | deepest |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for kind, radius, length in DISCS:
        for restitution in RESTITUTIONS:
            for friction in FRICTIONS:
                rng = np.random.default_rng(9)
                found = [landing_disc(kind, radius, length, restitution, friction, rng) for _ in range(starts)]
                above, rise, depth = np.array(found).T
                counted = f"{np.count_nonzero(rise > 0.01)} of {starts} | {rise.max():.1e} | {depth.max():.1e} m"
                print(
                    f"| {kind}, {radius} m, {length} m high | {restitution} | {friction} | {above.max():.1e} | {counted} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
