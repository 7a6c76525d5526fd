"""Ctrl-C at any line of what is done to a world: it is done then, or has not begun, and time goes with the bodies.

``python tests/fuzz_interruptions.py --count 400`` tries so many.
"""

import copy
import functools
import signal
import sys

import hostile
import numpy as np
from fuzz_world_files import pile

import kickdrift as kd

STEP = 1 / 60
FEW = 3  # steps
SKIPPED = ("EVENTS", "STEP_STATUS")  # of the last call of `advance`


def pull(position, force):
    """Draw all bodies to the middle."""
    for body in range(len(force)):
        force[body, 0] -= position[body, 0]


def hull():
    """Return points of a hull."""
    return np.random.default_rng(0).normal(size=(12, 3))


OPERATIONS = {
    "step": lambda world: world.step(STEP),
    "advance": lambda world: world.advance(STEP, FEW),
    "add_sphere": lambda world: world.add_sphere(0.2, position=(0, 5, 5), name="new"),
    "add_hull": lambda world: world.add_hull(hull(), position=(0, 5, 5), restitution=0.5),
    "add_mesh": lambda world: world.add_mesh([(0, 5, 0), (1, 5, 0), (0, 6, 0)], [(0, 1, 2)]),
    "add_hinge": lambda world: world.add_hinge(None, world.body("ball"), anchor=(0, 0, 4), axis=(1, 0, 0), name="new"),
    "add_gear": lambda world: world.add_gear(world.joints.handle(1), world.joints.handle(2), 2.0),
    "remove": lambda world: world.remove(world.bodies.handle(4)),
    "remove a joined one": lambda world: world.remove(world.body("rod")),
    "remove_joint": lambda world: world.remove_joint(world.joint("first")),
    "set_drive": lambda world: world.joint("first").set_drive(kd.Drive(3.0, 1.0)),
    "set_limits": lambda world: world.joint("first").set_limits((-1.0, 1.0)),
    "gravity": lambda world: setattr(world, "gravity", (0, 0, -1.0)),
    "name": lambda world: setattr(world.body("ball"), "name", "other"),
    "mass": lambda world: setattr(world.body("ball"), "mass", 3.0),
    "friction": lambda world: setattr(world.body("ball"), "friction", 0.1),
    "exclude": lambda world: world.exclude(world.bodies.handle(2), world.bodies.handle(3)),
    "add_force": lambda world: world.add_force(pull),
    "restore": lambda world: world.restore(original()[1]),
    "ray_cast": lambda world: world.ray_cast((0, 0, 9), (0, 0, -1)),
}

LAWS = ("set_drive", "set_limits")


@functools.cache
def original():
    """Return a world that has run for a while, and a snapshot of it at another time."""
    world = pile()
    world.bodies.handle(16).name = "rod"
    world.joints.handle(0).name = "first"
    world.advance(STEP, 40)
    snapshot = world.snapshot()
    world.advance(STEP, 3)
    return world, snapshot


@functools.cache
def compile_all():
    """Do everything once, so that nothing is compiled where lines are counted."""
    for operation in OPERATIONS.values():
        operation(copy.copy(original()[0]))


def whole(world, tables=None):
    """Return all that the next steps of a world depend on, or some tables of it."""
    snapshot = world.snapshot()
    members = {"time": snapshot.time, "n_steps": snapshot.n_steps}
    if tables is None:
        names = ("free_bodies", "free_shapes", "kinds", "bouncing", "body_names", "joint_names")
        members |= {name: getattr(snapshot, name) for name in names}
        members |= {"shapes": list(snapshot.shapes), "forces": len(snapshot.forces), "broken": len(world.broken)}
    kept = [name for name in snapshot.tables if name not in SKIPPED] if tables is None else tables
    return members | {name: snapshot.tables[name].tobytes() for name in kept}


def interrupted(world, operation, line):
    """Do something, with Ctrl-C at the so manieth line of kickdrift; return how many lines it has."""
    count = 0

    def trace(frame, event, argument):
        nonlocal count
        if "kickdrift" not in frame.f_code.co_filename:
            return None
        if event == "line":
            count += 1
            if count == line:
                signal.raise_signal(signal.SIGINT)
        return trace

    sys.settrace(trace)
    try:
        operation(world)
    except KeyboardInterrupt:
        pass
    finally:
        sys.settrace(None)
    return count


def attempt(seed):
    """Interrupt one operation at one line, and compare with worlds in which it was done, or was not."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    compile_all()
    rng = np.random.default_rng(seed)
    name = list(OPERATIONS)[seed % len(OPERATIONS)]
    operation, world = OPERATIONS[name], copy.copy(original()[0])
    done, not_done = copy.copy(world), copy.copy(world)
    line = int(rng.integers(1, 1 + interrupted(done, operation, -1)))
    interrupted(world, operation, line)
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return f"{name} at line {line}: Ctrl-C is dead"
    if name in ("step", "advance"):
        steps = world.n_steps - not_done.n_steps
        not_done.advance(STEP, steps)
        tables = ("POSE", "MOTION", "LOAD")
        return (
            None if whole(world, tables) == whole(not_done, tables) else f"{name} at line {line}: after {steps} steps"
        )
    now, before = whole(world), whole(not_done)
    if name in LAWS:  # which wake bodies first, and may have done no more than that
        before |= {table: now[table] for table in ("BODY", "RESTED")}
    if now not in (whole(done), before):
        wrong = [key for key, value in whole(world).items() if value not in (whole(done)[key], whole(not_done)[key])]
        return f"{name} at line {line} is half done: {wrong}"
    world.advance(STEP, 2)
    return None if np.isfinite(world.velocity).all() else f"{name} at line {line}: not finite"


if __name__ == "__main__":
    sys.exit(hostile.main("fuzz_interruptions", __doc__))
