"""Random worlds: all shapes, grounds and joints, with limits, motors, springs and friction, sizes over three decades.

``python tests/random_worlds.py --seeds 20 --steps 10000`` runs them to the end and says what became of each.
"""

import argparse
import sys
import time

import numpy as np

import kickdrift as kd
from kickdrift.core.errors import KickdriftError
from kickdrift.world.bodies.part import Part
from kickdrift.world.joint_gaps import widest_gap
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.sphere import Sphere

GRAVITY = 9.81
TREES, GROUND_SIZE = 5, 40  # of joints, and half the edge of a ground that ends
LOCKED, FREE = kd.Axis(locked=True), kd.Axis()


def random_world(seed):
    """Return a world and the size of its largest bodies, in m: trees of two to eight bodies, some with loops, some held."""
    rng = np.random.default_rng(seed)
    world = kd.World(sleeping=bool(rng.random() < 0.3))
    scale = 10 ** rng.uniform(-2, 1)
    add_ground(rng, world, scale)
    for tree in range(TREES):
        size, density = scale * 10 ** rng.uniform(-1, 0), 10 ** rng.uniform(2, 3.5)
        at = scale * np.array([6 * (tree % 3 - 1), 6 * (tree // 3 - 1), 2 + rng.uniform(0, 3)])
        add_tree(rng, world, scale, size, density, at)
    return world, scale


def add_ground(rng, world, scale):
    """Add a floor that is a plane, a box, a height field or a mesh."""
    surface = {"friction": rng.uniform(0, 1.2), "restitution": rng.choice([0.0, 0.0, 0.5])}
    edge = 2 * GROUND_SIZE * scale
    match rng.integers(4):
        case 0:
            world.add_plane(**surface)
        case 1:
            world.add_box((edge, edge, 4 * scale), position=(0, 0, -2 * scale), static=True, **surface)
        case 2:
            heights = scale * rng.uniform(-0.5, 0.5, (21, 21))
            world.add_height_field(heights, edge / 20, position=(-edge / 2, -edge / 2, 0), **surface)
        case _:
            x, y = np.meshgrid(*2 * [np.linspace(-GROUND_SIZE, GROUND_SIZE, 17)], indexing="ij")
            z = 0.5 * np.sin(x / 4) * np.cos(y / 5)
            corner = 17 * np.arange(16)[:, None] + np.arange(16)
            below = np.stack([corner, corner + 17, corner + 18], axis=-1)
            above = np.stack([corner, corner + 18, corner + 1], axis=-1)
            faces = np.concatenate([below.reshape(-1, 3), above.reshape(-1, 3)])
            world.add_mesh(scale * np.stack([x, y, z], axis=-1).reshape(-1, 3), faces, **surface)


def add_tree(rng, world, scale, size, density, at):
    """Add bodies in a row, each joined to one of the two before it."""
    bodies, places = [], []
    for k in range(int(rng.integers(2, 9))):
        place = at + (0 if k == 0 else size) * (np.array([0.9 * k, 0, 0]) + 0.15 * rng.normal(size=3))
        body = world.add_body(
            a_shape(rng, size * rng.uniform(0.3, 0.6)),
            position=place,
            orientation=rng.normal(size=4),
            velocity=rng.normal(size=3) * rng.choice([0, 1]) * np.sqrt(GRAVITY * scale),
            density=density * 10 ** rng.uniform(-0.3, 0.3),
            friction=rng.uniform(0, 1.2),
            restitution=rng.choice([0.0, 0.0, 0.5, 0.9]),
            rolling_resistance=rng.choice([0, 0.01 * size]),
        )
        bodies.append(body)
        places.append(world.position[body.index].copy())
        if k:
            before = int(rng.integers(max(0, k - 2), k))
            join(rng, world, (bodies[before], body), (places[before], places[k]), 0.3 * density * size**3, size)
    if len(bodies) > 3 and rng.random() < 0.4:
        world.add_ball_joint(bodies[0], bodies[-1], anchor=0.5 * (places[0] + places[-1]))
    if rng.random() < 0.3:
        world.add_ball_joint(world.ground, bodies[0], anchor=places[0])


def a_shape(rng, reach):
    """Return a shape, or the parts of a body, no point of which is farther than `reach` from the origin."""
    match rng.integers(5):
        case 0:
            return Sphere(reach)
        case 1:
            return Capsule(reach / 3, 4 / 3 * reach)
        case 2:
            size = rng.uniform(0.1, 1.0, 3)
            return Box(2 * reach * size / np.linalg.norm(size))
        case 3:
            points = rng.normal(size=(int(rng.integers(6, 20)), 3))
            return Hull(points * reach / np.linalg.norm(points, axis=1).max())
        case _:
            bar = Part(Box((reach, reach / 4, reach / 4)))
            return [bar, Part(Sphere(reach / 3), position=(reach / 2, 0, 0), density=5000.0)]


def join(rng, world, bodies, places, mass, size):
    """Join two bodies halfway between them, in one of nine ways."""
    middle, axis = 0.5 * (places[0] + places[1]), rng.normal(size=3)
    ends = {"anchor_a": places[0], "anchor_b": places[1]}
    weight = mass * GRAVITY

    def turns():
        return law(rng, weight * size, 1.0)

    def slides():
        return law(rng, weight, size)

    match rng.integers(9):
        case 0:
            options = {}
            if rng.random() < 0.5:
                options["swing_limit"] = rng.uniform(0.1, 2.5)
            if rng.random() < 0.5:
                options["twist_limits"] = (-rng.uniform(0, 2), rng.uniform(0, 2))
            if rng.random() < 0.5:
                torque = weight * size * 10 ** rng.uniform(-1, 2)
                options["drive"] = kd.Drive(torque, weight * size * 10 ** rng.uniform(-2, 0))
            if rng.random() < 0.3:
                options["friction"] = weight * size * rng.uniform(0, 0.3)
            world.add_ball_joint(*bodies, anchor=middle, axis=axis, **options)
        case 1:
            world.add_hinge(*bodies, anchor=middle, axis=axis, **turns())
        case 2:
            world.add_slider(*bodies, anchor=middle, axis=axis, **slides())
        case 3:
            world.add_fixed_joint(*bodies, anchor=middle)
        case 4:
            across = np.cross(axis, rng.normal(size=3))
            about = {"about_a": kd.Axis(**turns()), "about_b": kd.Axis(**turns())}
            world.add_universal_joint(*bodies, anchor=middle, axis_a=axis, axis_b=across, **about)
        case 5:
            across = np.cross(axis, rng.normal(size=3))
            linear = tuple(LOCKED if rng.random() < 0.6 else kd.Axis(**slides()) for _ in range(3))
            angular, locked = (FREE, FREE, FREE), rng.integers(3)
            if rng.random() < 0.7:
                held = (k == locked or rng.random() < 0.4 for k in range(3))
                angular = tuple(LOCKED if one else kd.Axis(**turns()) for one in held)
            axes = {"axis_x": axis, "axis_y": across}
            world.add_six_dof_joint(*bodies, anchor=middle, **axes, linear=linear, angular=angular)
        case 6:
            world.add_distance_joint(*bodies, **ends)
        case 7:
            world.add_rope_joint(
                *bodies, **ends, length=rng.uniform(0.8, 2) * float(np.linalg.norm(places[1] - places[0]))
            )
        case _:
            world.add_spring(*bodies, **ends, hertz=10 ** rng.uniform(-0.5, 1.3), damping_ratio=rng.uniform(0, 1))


def law(rng, force, span):
    """Return limits, a motor, a drive and friction for an axis, any of which may be missing."""
    parts = {}
    if rng.random() < 0.4:
        parts["limits"] = (-span * rng.uniform(0, 1.5), span * rng.uniform(0, 1.5))
    if rng.random() < 0.3:
        parts["motor"] = kd.Motor(span * rng.normal() * 3, force * 10 ** rng.uniform(-1, 1))
    if rng.random() < 0.5:
        if rng.random() < 0.7:
            stiffness, damping = force / span * 10 ** rng.uniform(-1, 3), force / span * 10 ** rng.uniform(-2, 1)
            parts["drive"] = kd.Drive(stiffness, damping, target=span * rng.normal() * 0.5)
        else:
            parts["drive"] = kd.Drive(hertz=10 ** rng.uniform(-0.5, 1.5), damping_ratio=rng.uniform(0, 2))
    if rng.random() < 0.3:
        parts["friction"] = force * 10 ** rng.uniform(-2, 0)
    return parts


def watched(world, scale, step, steps):
    """Run a world; return its greatest speed over that of falling by its scale, and the widest gap at a joint over that."""
    speed = gap = 0.0
    for done in range(0, steps, 10):
        world.advance(step, min(10, steps - done))
        above = world.position[:, 2] > -2 * scale  # those that have gone over the end of the ground fall for ever
        speed = max(speed, np.abs(world.velocity[above]).max() / np.sqrt(GRAVITY * scale))
        gap = max(gap, widest_gap(world.tables) / scale)
    return speed, gap


def main():
    """Print a table, and return how many of the worlds did not come to the end of the steps."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--step", type=float, default=1 / 60)
    arguments = parser.parse_args()
    print("| seed | size, m | bodies | end | greatest speed / that of falling | widest gap / size | s |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    failed = 0
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        world, scale = random_world(seed)
        started, end, speed, gap = time.perf_counter(), "reached", np.nan, np.nan
        try:
            speed, gap = watched(world, scale, arguments.step, arguments.steps)
        except KickdriftError as error:
            end = str(error)
        if not np.isfinite(np.hstack([world.position, world.orientation, world.velocity])).all():
            end = "not finite"
        failed += end != "reached"
        seconds = time.perf_counter() - started
        bodies = len(world.position) - 2
        print(f"| {seed} | {scale:.2g} | {bodies} | {end} | {speed:.2g} | {gap:.1g} | {seconds:.1f} |", flush=True)
    return failed


if __name__ == "__main__":
    sys.exit(main())
