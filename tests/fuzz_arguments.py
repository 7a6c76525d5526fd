"""Hostile arguments: whatever `kd.solve`, worlds and classes are given, they take it or say in a sentence why not.

``python tests/fuzz_arguments.py --count 4200`` tries so many: in turn one of `solve`, one of a world, one of a class.
"""

import copy
import decimal
import functools
import inspect
import pathlib
import sys
from fractions import Fraction

import hostile
import numpy as np

import kickdrift as kd
from kickdrift.core.errors import KickdriftError
from kickdrift.core.kinds import Kind
from kickdrift.methods.letter import Letter
from kickdrift.methods.record import Method
from kickdrift.methods.tableau import Tableau
from kickdrift.world.bodies.part import Part
from kickdrift.world.joints.limits_motors_options import Axis, Drive, Motor
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.cone import Cone
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.sphere import Sphere

STEP = 1 / 60


class Odd:
    """What raises wherever one looks."""

    def __float__(self):
        raise RuntimeError("no float")

    def __len__(self):
        raise RuntimeError("no length")

    def __array__(self, *_, **__):
        raise RuntimeError("no array")

    def __bool__(self):
        raise RuntimeError("no truth")

    def __eq__(self, other):
        raise RuntimeError("no comparison")

    __hash__ = None


COMPLEX = (1j, 1 + 2j, np.complex128(1 + 1j), np.array([1 + 1j, 0, 0]), np.array([1j, 0]), [1j, 2, 3])
VALUES = (
    None, True, False, 0, 1, -1, 2, 3, 7, 10**400, -(10**400), 2**63, 0.0, -0.0, 1.5, -1.5, 1e308, 5e-324, 1e-320,
    float("nan"), float("inf"), -float("inf"), "", "1", "nan", "no", "\0", "x" * 3000, "'...vefrl-4'?.", b"1", (), [], {},
    set(), [None], ["a"], [1], [1, 2], [1, 2, 3], (1, 2, 3, 4), [[1, 2], [3]], [[1, 2, 3]], [[[]]], [10**400, 0, 0],
    np.zeros(0), np.zeros(3), np.ones(3), np.ones((2, 2)), np.ones((3, 3)), np.ones((0, 3)), np.full(3, np.nan),
    np.array([1, 2, 3], dtype=object), np.array(["a", "b"]), np.array("2020-01-01", dtype="datetime64[s]"),
    np.array([True, False, True]), np.float32(1.5), np.int8(3), np.bool_(True), np.float64("nan"), np.array(2.0),
    np.ma.masked, np.ones(3, dtype=np.float16), decimal.Decimal("1.5"), Fraction(1, 3), range(3), iter([1, 2, 3]),
    object(), Odd(), print, lambda: None, lambda *a, **k: None, lambda x: x, functools.partial(max, 1), int, type, slice(1),
    Ellipsis, NotImplemented, np.add, kd, pathlib.Path("a"), [1, [2, 3]], {"a": 1}, {1: "a"}, memoryview(b"abc"),
    (0.0, 1e-300), (1.0, 0.0), (0.0, float("inf")), [1, 2, "3"], *COMPLEX,
)  # fmt: skip


def attraction(x):
    """Return the acceleration of a Kepler orbit."""
    return -x / np.linalg.norm(x) ** 3


def simple():
    """Return a world with a floor, some balls, a hinge and a slider."""
    world = kd.World()
    world.add_plane()
    for k in range(3):
        world.add_sphere(0.2, position=(k, 0, 1), name=f"ball {k}")
    world.add_hinge(None, world.body("ball 0"), anchor=(0, 0, 2), axis=(0, 1, 0), name="hinge")
    world.add_slider(None, world.body("ball 1"), anchor=(1, 0, 2), axis=(0, 0, 1), name="slider")
    world.step(STEP)
    return world


@functools.cache
def template():
    """Return a world to copy."""
    return simple()


# What is called, with arguments that it takes.
def described(kind, **arguments):
    """Return what solves a problem of a kind of description, and arguments that the description takes."""

    def solve(**given):
        start = {"x0": [1.0, 0.0]} if kind is kd.FirstOrder else {"x0": [[1.0, 0.0, 0.0]], "v0": [[0.0, 1.0, 0.0]]}
        return kd.solve(kind(**given), t_span=(0, 1), step=0.1, compile=False, progress=False, **start)

    return solve, arguments


SOLVE = [
    described(kd.Newtonian, force=attraction, mass=1.0, energy=None, invariants={}),
    described(kd.Damped, force=attraction, damping=0.1, mass=1.0),
    described(kd.Separable, kinetic_gradient=lambda p: p, potential_gradient=lambda q: q),
    described(kd.ChargedParticle, charge_to_mass=1.0, magnetic_field=lambda x: np.array([[0.0, 0.0, 1.0]])),
    described(kd.Langevin, force=attraction, friction=1.0, temperature=1.0, mass=1.0, seed=3),
    described(kd.Constrained, force=attraction, constraint=lambda x: np.sum(x**2) - 1.0, mass=1.0),
    described(kd.FirstOrder, rates=lambda y: -y, energy=None),
    (
        lambda **given: kd.solve(given.pop("problem"), **given),
        {
            "problem": attraction, "t_span": (0.0, 1.0), "x0": [1.0, 0.0], "v0": [0.0, 1.0], "step": 0.1, "method": "leapfrog",
            "order": None, "t_eval": None, "save_every": 1, "args": (), "compensated": False, "progress": False,
            "compile": False,
        },
    ),
    (
        lambda **given: kd.solve(kd.SecondOrder(**given), t_span=(0, 1), x0=[1, 0], v0=[0, 1], step=0.1, compile=False),
        {"acceleration": attraction, "energy": None},
    ),
    (kd.systems.nbody, {"masses": [1.0, 2.0], "x0": [[0, 0, 0], [1, 0, 0]], "v0": [[0, 0, 0], [0, 1, 0]], "softening": 0.1}),
    (kd.systems.planetary, {"masses": [1.0, 1e-3], "x0": [[0, 0, 0], [1, 0, 0]], "v0": [[0, 0, 0], [0, 1, 0]]}),
]  # fmt: skip
OF_BODIES = {
    "position": (0, 0, 5), "orientation": (1, 0, 0, 0), "velocity": (0, 0, 0), "angular_velocity": (0, 0, 0), "density": 10.0,
    "static": False, "kinematic": False, "damping": 0.0, "angular_damping": 0.0, "locked_rotation": False, "name": "new",
    "friction": 0.5, "restitution": 0.0, "rolling_resistance": 0.0, "surface_velocity": (0, 0, 0), "layer": 0,
    "collides_with": None, "sensor": False,
}  # fmt: skip
POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
OF_WORLDS = {
    "add_sphere": {"radius": 0.1, **OF_BODIES},
    "add_box": {"size": (1, 1, 1), **OF_BODIES},
    "add_capsule": {"radius": 0.1, "length": 1.0, **OF_BODIES},
    "add_hull": {"points": POINTS, **OF_BODIES},
    "add_plane": {"normal": (0, 0, 1), "point": (0, 0, 0)},
    "add_mesh": {"vertices": POINTS, "faces": [(0, 1, 2)]},
    "add_height_field": {"heights": np.zeros((3, 3)), "spacing": 1.0},
    "add_body": {"shapes": Sphere(0.1), "mass": None, "inertia": (1, 1, 1), "centre": (0, 0, 0), **OF_BODIES},
    "add_rope": {"points": [(0, 0, 9), (1, 0, 9), (1, 1, 9)], "radius": 0.01, "self_collision": False, "name": "line"},
    "add_soft_body": {"vertices": POINTS, "tetrahedra": [(0, 1, 2, 3)], "young_modulus": 1e4, "poisson_ratio": 0.3},
    "add_soft_box": {"size": (1, 1, 1), "cells": (2, 1, 1), "position": (0, 0, 9), "orientation": (1, 0, 0, 0)},
    "add_hinge": {"body_a": None, "body_b": "ball 2", "anchor": (2, 0, 2), "axis": (0, 1, 0), "limits": (-1.0, 1.0)},
    "add_ball_joint": {"body_a": None, "body_b": "ball 2", "anchor": (2, 0, 2), "axis": (0, 1, 0), "swing_limit": 1.0},
    "add_rope_joint": {"body_a": None, "body_b": "ball 2", "anchor_a": (2, 0, 2), "anchor_b": (2, 0, 1), "length": 2.0},
    "add_spring": {"body_a": None, "body_b": "ball 2", "anchor_a": (2, 0, 2), "anchor_b": (2, 0, 1), "hertz": 2.0},
    "add_gear": {"joint_a": "hinge", "joint_b": "slider", "ratio": 2.0, "axis_a": None, "axis_b": None},
    "add_force": {"force": attraction},
    "apply_force": {"body": "ball 1", "force": (1, 0, 0), "point": (0, 0, 0)},
    "apply_torque": {"body": "ball 1", "torque": (1, 0, 0)},
    "remove": {"body": "ball 1"},
    "remove_joint": {"joint": "hinge"},
    "body": {"name": "ball 1"},
    "exclude": {"body_a": "ball 1", "body_b": "ball 2"},
    "ray_cast": {"origin": (0, 0, 9), "direction": (0, 0, -1), "limit": 10.0, "layers": None, "ignore": ()},
    "ray_cast_many": {"origins": (0, 0, 9), "directions": [(0, 0, -1)], "limit": 10.0, "layers": None, "ignore": ()},
    "overlap_box": {"size": (1, 1, 1), "position": (0, 0, 0), "orientation": (1, 0, 0, 0)},
    "overlap_sphere": {"radius": 1.0, "position": (0, 0, 0)},
    "step": {"step": STEP},
    "advance": {"step": STEP, "count": 3},
    "run": {"duration": 0.1, "step": STEP, "save_every": None, "progress": False},
    "record": {"save_every": 1},
    "restore": {"snapshot": None},
    "save": {"path": "/dev/null/a"},
}
ATTRIBUTES = {
    "world": ("gravity", "substeps", "sleeping"),
    "body": ("position", "orientation", "velocity", "angular_velocity", "mass", "inertia", "locked_rotation", "friction",
             "restitution", "name"),
    "joint": ("angle", "speed", "name"),
}  # fmt: skip
CLASSES = [
    (kd.World, {"gravity": (0, 0, -9.81), "substeps": 4, "midpoint": True, "margin": 0.02, "slop": 0.005, "contact_hertz": 30.0,
                "contact_damping": 4.0, "push_speed": 1.5, "bounce_speed": 1.0, "sleeping": False, "sleep_speed": 0.05,
                "sleep_time": 0.5, "threads": False, "plane_normal": (0, 0, 1)}),
    (Sphere, {"radius": 1.0}), (Box, {"size": (1, 1, 1)}), (Capsule, {"radius": 1.0, "length": 1.0}),
    (Cylinder, {"radius": 1.0, "length": 1.0}), (Cone, {"radius": 1.0, "length": 1.0}), (Hull, {"points": POINTS}),
    (Mesh, {"vertices": POINTS, "faces": [(0, 1, 2)]}), (HeightField, {"heights": np.zeros((3, 3)), "spacing": 1.0}),
    (Part, {"shape": Sphere(1.0), "position": (0, 0, 0), "orientation": (1, 0, 0, 0), "density": 1.0, "friction": 0.5}),
    (Drive, {"stiffness": 1.0, "damping": 1.0, "target": 0.0, "speed": 0.0, "maximum": 10.0}),
    (Drive, {"hertz": 1.0, "damping_ratio": 1.0}), (Motor, {"speed": 1.0, "maximum": 1.0}),
    (Axis, {"limits": (-1.0, 1.0), "motor": None, "drive": None, "friction": 0.0, "locked": False}),
    (Tableau, {"a": [[0.5]], "b": [1.0]}),
    (Method, {"name": "own", "order": 1, "word": ((Letter.KICK, Fraction(1)), (Letter.DRIFT, Fraction(1))), "symmetric": False,
              "kind": Kind.SEPARABLE, "source": "", "aliases": (), "tableau": None, "parameters": (), "corrector": ()}),
]  # fmt: skip


_DIRECT = next(k for k, (_, arguments) in enumerate(SOLVE) if "problem" in arguments)


def wrong_value(rng):
    """Draw a hostile value."""
    return VALUES[rng.integers(len(VALUES))]


def changed(rng, arguments):
    """Return arguments of which one or two are hostile, and which ones."""
    names = rng.choice(list(arguments), size=min(len(arguments), 1 + (rng.random() < 0.2)), replace=False)
    return {**arguments, **{str(name): wrong_value(rng) for name in names}}, [str(name) for name in names]


def said(call, what, values=()):
    """Call, and return what is wrong with the answer."""
    try:
        call()
        if any(value is part for value in values for part in COMPLEX):
            return f"{what}: accepted, without the imaginary part"
    except KickdriftError as error:
        sentence = str(error)
        return None if len(sentence) > 15 and " " in sentence else f"{what}: no sentence: {sentence!r}"
    except Warning:
        return None
    except BaseException as error:
        return f"{what}: raw {type(error).__name__}: {error}"
    return None


def recorded(world, save_every):
    """Record some steps."""
    with world.record(save_every=save_every):
        world.advance(STEP, 2)


def with_handles(world, arguments):
    """Put the handles of a world where their names stand."""
    found = {name: world.bodies.handle(row) for row, name in world.bodies.names.all().items()}
    found |= {name: world.joints.handle(row) for row, name in world.joints.names.all().items()}
    return {key: found.get(value, value) if isinstance(value, str) else value for key, value in arguments.items()}


def of_solve(rng):
    """Try `kd.solve`, or a description for it."""
    function, arguments = SOLVE[_DIRECT] if rng.random() < 0.5 else SOLVE[rng.integers(len(SOLVE))]
    given, names = changed(rng, arguments)
    return said(
        lambda: function(**given), f"solve {[(name, _short(given[name])) for name in names]}", _of(given, names)
    )


def _of(given, names):
    return [given[name] for name in names]


def of_a_world(rng):
    """Try a method or an attribute of a world, a body or a joint, and go on with the world."""
    world = copy.copy(template())
    if rng.random() < 0.2:
        kind = str(rng.choice(list(ATTRIBUTES)))
        owner = {"world": world, "body": world.body("ball 1"), "joint": world.joint("hinge")}[kind]
        name, value = str(rng.choice(ATTRIBUTES[kind])), wrong_value(rng)
        what = f"{kind}.{name} = {_short(value)}"
        wrong = said(lambda: setattr(owner, name, value), what, [value])
    else:
        name = str(rng.choice(list(OF_WORLDS)))
        given, names = changed(rng, with_handles(world, OF_WORLDS[name]))
        what = f"World.{name} {[(key, _short(given[key])) for key in names]}"
        method = recorded if name == "record" else getattr(kd.World, name)
        wrong = said(lambda: method(world, **given), what, _of(given, names))
    return wrong or said(lambda: world.advance(STEP, 3), what + ", then advance")


def of_classes(rng):
    """Try to make an object of a class."""
    kind, arguments = CLASSES[rng.integers(len(CLASSES))]
    given, names = changed(rng, arguments)
    return said(
        lambda: kind(**given), f"{kind.__name__} {[(name, _short(given[name])) for name in names]}", _of(given, names)
    )


def _short(value):
    try:
        return repr(value)[:60]
    except Exception:
        return type(value).__name__


def attempt(seed):
    """Try one of the three."""
    rng = np.random.default_rng(seed)
    return (of_solve, of_a_world, of_classes)[seed % 3](rng)


if __name__ == "__main__":
    assert inspect.isfunction(attempt)
    sys.exit(hostile.main("fuzz_arguments", __doc__))
