"""Sequences of operations on a world, some of them on what is gone: it goes on, and copies and files of it with the same bits.

``python tests/fuzz_operations.py --count 400`` tries so many, of 120 operations each.
"""

import copy
import sys
import tempfile
from pathlib import Path

import hostile
import numpy as np
from random_worlds import a_shape

import kickdrift as kd
from kickdrift.core.errors import KickdriftError
from kickdrift.world.joints.limits_motors_options import Drive, Motor
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.mesh import Mesh

STEP = 1 / 60
OPERATIONS = 120


def pull(position, force):
    """Draw all bodies to the middle."""
    for body in range(len(force)):
        force[body, 0] -= 0.1 * position[body, 0]


class Player:
    """A world, the handles that it has given, and snapshots of it."""

    def __init__(self, rng):
        self.rng = rng
        self.world = kd.World(sleeping=bool(rng.random() < 0.5), sleep_time=0.05)
        self.bodies, self.joints, self.snapshots = [self.world.ground], [], []

    def body(self):
        """Return the handle of a body that is, or now and then of one that was."""
        there = [body for body in self.bodies if self.world.bodies.knows(body.index, body.generation)]
        bodies = self.bodies if self.rng.random() < 0.05 else there
        return bodies[self.rng.integers(len(bodies))]

    def joint(self):
        """Return the handle of a joint that is, or now and then of something else."""
        there = [joint for joint in self.joints if self.world.joints.knows(joint.index, joint.generation)]
        return there[self.rng.integers(len(there))] if there and self.rng.random() < 0.95 else self.body()

    def place(self):
        """Return a point."""
        return self.rng.normal(size=3) * 2 + (0, 0, 3)

    def add(self):
        rng = self.rng
        options = {"position": self.place(), "orientation": rng.normal(size=4), "restitution": rng.choice([0, 0, 0.5])}
        options |= {
            "static": bool(rng.random() < 0.1),
            "layer": int(rng.integers(3)),
            "sensor": bool(rng.random() < 0.1),
        }
        self.bodies.append(self.world.add_body(a_shape(rng, rng.uniform(0.1, 0.6)), **options))

    def add_ground(self):
        shape = (
            Mesh([(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [(0, 1, 2)])
            if self.rng.random() < 0.5
            else HeightField(0.1 * self.rng.normal(size=(5, 5)), 4.0)
        )
        self.bodies.append(self.world.add_body(shape, static=True, position=(0, 0, -self.rng.random())))

    def join(self):
        kind = str(self.rng.choice(["add_hinge", "add_ball_joint", "add_fixed_joint", "add_slider"]))
        axis = {"axis": self.rng.normal(size=3)} if kind in ("add_hinge", "add_slider") else {}
        self.joints.append(getattr(self.world, kind)(self.body(), self.body(), anchor=self.place(), **axis))

    def gear(self):
        self.joints.append(self.world.add_gear(self.joint(), self.joint(), float(self.rng.normal())))

    def law(self):
        which = self.rng.integers(3)
        joint = self.joint()
        if joint in self.bodies:
            return
        if which == 0:
            joint.set_drive(Drive(10.0, 1.0, target=float(self.rng.normal())))
        elif which == 1:
            joint.set_motor(Motor(1.0, 5.0) if self.rng.random() < 0.7 else None)
        else:
            joint.set_limits((-0.5, 0.5))

    def change(self):
        name, value = [
            ("mass", 2.0), ("friction", 0.3), ("restitution", 0.4), ("locked_rotation", bool(self.rng.random() < 0.5)),
            ("position", self.place()), ("orientation", self.rng.normal(size=4)), ("velocity", self.rng.normal(size=3)),
            ("angular_velocity", 5 * self.rng.normal(size=3)), ("name", str(self.rng.integers(5))),
        ][self.rng.integers(9)]  # fmt: skip
        setattr(self.body(), name, value)

    def settings(self):
        name, value = [("substeps", int(self.rng.integers(1, 6))), ("gravity", (0, 0, -5)), ("sleeping", True)][
            self.rng.integers(3)
        ]
        setattr(self.world, name, value)

    def push(self):
        self.world.apply_force(self.body(), 10 * self.rng.normal(size=3), self.place())

    def remove(self):
        self.world.remove(self.body())

    def remove_joint(self):
        self.world.remove_joint(self.joint())

    def exclude(self):
        self.world.exclude(self.body(), self.body())

    def step(self):
        self.world.advance(STEP, int(self.rng.integers(1, 6)))

    def ask(self):
        self.world.ray_cast(self.place(), self.rng.normal(size=3))
        self.world.overlap_sphere(1.0, self.place())
        repr((self.world.touching, self.world.events, self.body(), self.world.energy()))

    def write(self):
        """Write into a live view, now and then what no body has."""
        value = np.nan if self.rng.random() < 0.02 else 0.1
        self.body().velocity[0] = value

    def snapshot(self):
        self.snapshots.append(self.world.snapshot())

    def restore(self):
        if self.snapshots:
            self.world.restore(self.snapshots[self.rng.integers(len(self.snapshots))])

    def force(self):
        self.world.add_force(pull)

    def swap(self):
        """Go on with a copy, with which the handles go."""
        self.world, self.bodies, self.joints = copy.deepcopy((self.world, self.bodies, self.joints))

    def play(self):
        """Do one thing."""
        often = [self.add, self.add, self.join, self.step, self.step, self.step, self.change, self.push]
        seldom = [
            self.remove,
            self.add_ground, self.gear, self.law, self.settings, self.remove_joint, self.exclude, self.ask, self.write,
            self.snapshot, self.restore, self.swap,
        ]  # fmt: skip
        chosen = often if self.rng.random() < 0.75 else seldom
        if self.rng.random() < 0.005:
            chosen = [self.force]
        chosen[self.rng.integers(len(chosen))]()


def bits(world):
    """Return where all is and how it moves."""
    return world.position.tobytes() + world.orientation.tobytes() + world.velocity.tobytes()


def ended(world):
    """Go on for a while; return the bits, or what was said."""
    try:
        world.advance(STEP, 10)
    except KickdriftError as error:
        return str(error)
    return bits(world)


def attempt(seed):
    """Do some things, and see how the world, a copy of it and one from a file go on."""
    player = Player(np.random.default_rng(seed))
    for _ in range(OPERATIONS):
        try:
            player.play()
        except KickdriftError:
            continue
    world = player.world
    with tempfile.TemporaryDirectory() as folder:
        path = world.save(Path(folder) / "world.npz")
        loaded = kd.load_world(path, forces=[pull] * len(world.forces))
    again = copy.copy(world)
    ends = [ended(each) for each in (world, again, loaded)]
    if ends[0] != ends[1]:
        return "a copy does not go on with the same bits"
    return None if ends[0] == ends[2] else "one from a file does not go on with the same bits"


if __name__ == "__main__":
    sys.exit(hostile.main("fuzz_operations", __doc__))
