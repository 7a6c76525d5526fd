"""Boxes and cylinders on cloth that lies on a floor or on other bodies: how they slide, and how still they stand.

``python tests/loads_on_cloth.py --starts 70`` prints for so many random loads how far they slide, and how fast cloth that is
pulled away makes them, both over what Coulomb's law says; how far a load goes with a cloth that is pulled slowly; and how far
loads on cloth on one to three loose boxes move in 2 s.
"""

import argparse

import numpy as np

import kickdrift as kd

STEP = 1 / 60


def load_on_cloth(seed, length):
    """Return a world with a random load at rest on a stiff cloth, and the deceleration by its friction, m/s^2."""
    rng = np.random.default_rng(seed)
    friction, mass, thickness = rng.uniform(0.15, 0.8), 10 ** rng.uniform(-1, 1), rng.uniform(0.003, 0.008)
    (a, b), height, yaw = rng.uniform(0.12, 0.4, 2), rng.uniform(0.03, 0.1), rng.uniform(0, np.pi)
    across, world = int(rng.integers(12, 20)), kd.World(substeps=int(rng.choice([4, 8])))
    if rng.random() < 0.5:
        world.add_box((6, 6, 1), position=(0, 0, -0.5), static=True, friction=friction)
    else:
        world.add_plane(friction=friction)
    fabric = {"damping": 2e-3, "stretch_stiffness": 3000.0, "shear_stiffness": 600.0, "thickness": thickness}
    size, vertices, at = (length, 1.0), (int(length * across), across), (0, 0, thickness / 2 + 1e-4)
    cloth = world.add_cloth_grid(size, vertices, position=at, friction=friction, **fabric)
    start = {"mass": mass, "friction": friction, "position": (0, 0, thickness + 2e-4 + height / 2)}
    if rng.random() < 0.3:
        load = world.add_cylinder(a / 2, height, **start)
    else:
        load = world.add_box((a, b, height), orientation=(np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)), **start)
    world.advance(STEP, 40)
    return world, cloth, load, friction * 9.81


def distance(seed):
    """Distance over which a load of 0.8 m/s slides on cloth that is held, over v^2 / (2 mu g)."""
    world, cloth, load, braking = load_on_cloth(seed, 1.0)
    cloth.pin(np.flatnonzero(np.abs(cloth.position[:, 0]) > 0.499))
    load.velocity = (0.8, 0, 0)
    start = load.position[0]
    world.advance(STEP, int(0.8 / braking / STEP) + 20)
    return (load.position[0] - start) / (0.8**2 / (2 * braking))


def acceleration(seed, speed=3.0):
    """Acceleration of a load as the cloth under it is pulled away with a speed, m/s, over mu g."""
    world, cloth, load, most = load_on_cloth(seed, 2.0)
    edge = np.flatnonzero(cloth.position[:, 0] > 0.999)
    cloth.pin(edge)
    for part in np.linspace(1 / 6, 1.0, 6):
        cloth.velocity[edge, 0] = part * speed
        world.step(STEP)
    before = load.velocity[0]
    world.advance(STEP, 6)
    return (load.velocity[0] - before) / (6 * STEP) / most


def way_with_cloth(mass):
    """Way of a load in 3 s on a cloth of 0.2 kg that a sled of 0.3 m/s pulls from the start, over that of the sled."""
    world = kd.World()
    world.add_plane(friction=0.4)
    fabric = {"damping": 2e-3, "stretch_stiffness": 2000.0, "shear_stiffness": 400.0, "friction": 0.4}
    cloth = world.add_cloth_grid((1, 1), (21, 21), position=(0, 0, 0.003), **fabric)
    load = world.add_box((0.4, 0.3, 0.1), position=(0, 0, 0.056), mass=mass, friction=0.4)
    sled = world.add_box((1, 1, 1), mass=1000.0, position=(0.6, 0, 0.003), velocity=(0.3, 0, 0), collides_with=())
    cloth.pin(np.flatnonzero(cloth.position[:, 0] > 0.499), sled)
    for _ in range(180):
        world.apply_force(sled, (0, 0, 9810.0))
        world.step(STEP)
    return load.position[0] / (sled.position[0] - 0.6)


def stack_with_cloth(seed):
    """Return a world and its bodies: up to two loads on cloth on up to three boxes, of 0.2 to 20 kg each, somewhat askew."""
    rng = np.random.default_rng(seed)
    world, bodies, top, edge = kd.World(substeps=int(rng.choice([4, 8]))), [], 0.0, rng.uniform(0.25, 0.4)
    world.add_plane(friction=0.6)
    for _ in range(rng.integers(1, 4)):
        height, yaw, friction = rng.uniform(0.08, 0.25), rng.uniform(0, 0.3), rng.uniform(0.4, 0.8)
        at = {"position": (0, 0, top + height / 2), "orientation": (np.cos(yaw / 2), 0, 0, np.sin(yaw / 2))}
        bodies.append(world.add_box((edge, edge, height), mass=10 ** rng.uniform(-0.5, 1.2), friction=friction, **at))
        top += height + 1e-4
    thickness, across = rng.uniform(0.003, 0.008), int(rng.integers(15, 26))
    fabric = {"thickness": thickness, "friction": rng.uniform(0.3, 0.7), "damping": 1e-3}
    world.add_cloth_grid((0.8, 0.8), (across, across), position=(0, 0, top + thickness / 2 + 1e-4), **fabric)
    top += thickness + 2e-4
    size, (x, y) = edge * rng.uniform(0.3, 0.7), edge * rng.uniform(-0.1, 0.1, 2)
    for _ in range(rng.integers(1, 3)):
        height, yaw, mass = rng.uniform(0.05, 0.15), rng.uniform(0, 3), 10 ** rng.uniform(-0.7, 1.3)
        at = {"position": (x, y, top + height / 2), "mass": mass}
        if rng.random() < 0.3:
            bodies.append(world.add_cylinder(size / 2, height, **at))
        else:
            turn = (np.cos(yaw / 2), 0, 0, np.sin(yaw / 2))
            bodies.append(world.add_box((size, size, height), orientation=turn, **at))
        top, size = top + height + 1e-4, 0.8 * size
    return world, bodies


def creep(seed):
    """Distance by which a body of a stack with cloth in it moves in 2 s, mm."""
    world, bodies = stack_with_cloth(seed)
    world.advance(STEP, 60)
    before = np.array([body.position for body in bodies])
    world.advance(STEP, 120)
    return 1e3 * np.abs(np.array([body.position for body in bodies]) - before).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=70)
    starts = parser.parse_args().starts
    print("| what | median | least | most | off by more than 1 % |\n| --- | --- | --- | --- | --- |")
    for what, measure in (("distance", distance), ("acceleration at 3 m/s", acceleration)):
        found = np.array([measure(seed) for seed in range(starts)])
        off = int((np.abs(found - 1.0) > 0.01).sum())
        print(
            f"| {what} | {np.median(found):.4f} | {found.min():.4f} | {found.max():.4f} | {off} of {starts} |",
            flush=True,
        )
    for mass in (0.1, 1.0, 10.0):
        print(f"| way of {mass} kg with a cloth of 0.2 kg | {way_with_cloth(mass):.3f} | | | |", flush=True)
    found = np.array([creep(seed) for seed in range(starts)])
    far = int((found > 0.5).sum())
    print(
        f"| moves in 2 s, mm | {np.median(found):.4f} | {found.min():.4f} | {found.max():.4f} | {far} of {starts} by 0.5 mm |"
    )


if __name__ == "__main__":
    main()
