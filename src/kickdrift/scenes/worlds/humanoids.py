"""People: ragdolls that fall, and one who stands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.rotations import Floats, about, turned
from kickdrift.core.vectors import Vector
from kickdrift.scenes.worlds.placing import between, scatter
from kickdrift.world.bodies.handle import Body
from kickdrift.world.joints.limits_motors_options import Drive
from kickdrift.world.world import World

Person = dict[str, Body]  # bodies by name, such as "pelvis" or "left thigh"


class Bone(NamedTuple):
    """A capsule of a person of 1.75 m and 75 kg who faces +x and stands on z = 0 with the arms down."""

    name: str
    parent: str
    start: Vector
    end: Vector
    radius: float
    mass: float
    anchor: Vector  # of the joint to the parent
    bend: tuple[float, float] | None = None  # limits about +y of a hinge; without them, the joint is a ball


_LEFT = [
    Bone("upper arm", "chest", (0, 0.24, 1.40), (0, 0.24, 1.18), 0.050, 2.2, (0, 0.24, 1.43)),
    Bone("forearm", "upper arm", (0, 0.24, 1.08), (0, 0.24, 0.88), 0.040, 1.6, (0, 0.24, 1.13), (-2.4, 0.0)),
    Bone("thigh", "pelvis", (0, 0.10, 0.86), (0, 0.10, 0.56), 0.075, 8.5, (0, 0.10, 0.92)),
    Bone("shin", "thigh", (0, 0.10, 0.42), (0, 0.10, 0.05), 0.050, 4.5, (0, 0.10, 0.49), (0.0, 2.4)),
]
_MIDDLE = [
    Bone("pelvis", "", (0, -0.07, 0.97), (0, 0.07, 0.97), 0.110, 11.0, (0, 0, 0.97)),
    Bone("chest", "pelvis", (0, 0, 1.21), (0, 0, 1.36), 0.135, 25.0, (0, 0, 1.08)),
    Bone("head", "chest", (0, 0, 1.60), (0, 0, 1.66), 0.090, 5.0, (0, 0, 1.50)),
]


def _side(bone: Bone, name: str, sign: float) -> Bone:
    start, end, anchor = ((x, sign * y, z) for x, y, z in (bone.start, bone.end, bone.anchor))
    parent = bone.parent if bone.parent in ("chest", "pelvis") else f"{name} {bone.parent}"
    return bone._replace(name=f"{name} {bone.name}", parent=parent, start=start, end=end, anchor=anchor)


BONES = [*_MIDDLE, *(_side(bone, name, sign) for name, sign in (("left", 1.0), ("right", -1.0)) for bone in _LEFT)]


PELVIS = 0.97  # its height of one who stands


def add_person(
    world: World,
    *,
    position: ArrayLike = (0.0, 0.0, PELVIS),
    orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    drive: Drive | None = None,
    bones: Sequence[Bone] = BONES,
) -> Person:
    """Add a humanoid of eleven bodies to a world: ball joints at neck, waist, shoulders and hips, hinges below.

    Parameters
    ----------
    world : World
    position : (3,) array_like
        Of the pelvis, in m.
    orientation : (4,) array_like
        Quaternion (w, x, y, z) that turns one who stands and faces +x.
    drive : Drive, optional
        Of each joint; without stiffness, the person is limp.
    bones : sequence of Bone
        Other bones.
    """

    def place(point: Vector) -> Floats:
        return np.add(position, turned(orientation, np.subtract(point, (0.0, 0.0, PELVIS))))

    bodies: Person = {}
    for bone in bones:
        limb = between(place(bone.start), place(bone.end))
        body = world.add_capsule(
            bone.radius, limb.length, position=limb.position, orientation=limb.orientation, mass=bone.mass, friction=0.6
        )
        bodies[bone.name] = body
        if not bone.parent:
            continue
        parent, anchor = bodies[bone.parent], place(bone.anchor)
        if bone.bend is None:
            world.add_ball_joint(parent, body, anchor=anchor, drive=drive)
        else:
            axis = turned(orientation, (0.0, 1.0, 0.0))
            world.add_hinge(parent, body, anchor=anchor, axis=axis, limits=bone.bend, drive=drive)
    return bodies


class Humanoid(NamedTuple):
    """A standing humanoid, and its bodies by name."""

    world: World
    bodies: Person


def ragdolls(*, count: int = 16, columns: int = 2, height: float = 0.5, damping: float = 1.0) -> World:
    """Drop limp humanoids, face down, onto each other.

    Parameters
    ----------
    count : int
        People.
    columns : int
        They begin above each other in so many columns by so many.
    height : float
        Of the lowest above the floor, in m.
    damping : float
        Of each joint, N m s/rad.
    """
    world = World()
    world.add_plane(friction=0.6)
    for number in range(count):
        layer, place = divmod(number, columns * columns)
        row, column = divmod(place, columns)
        middle = (columns - 1) / 2
        x = (column - middle) * 2.0 + 0.7 * (layer % 2)  # lying humanoids take 1.8 m by 0.6 m
        position = (x, (row - middle) * 0.8, height + 0.8 * layer)
        lean = about((0.0, 1.0, 0.0), math.pi / 2 + 0.3 * scatter(number))
        add_person(world, position=position, orientation=lean, drive=Drive(damping=damping))
    return world


def humanoid(*, stiffness: float = 1000.0, damping: float = 50.0) -> Humanoid:
    """Let a person stand on two feet, each joint held by a spring and a damper.

    Parameters
    ----------
    stiffness : float
        N m/rad. With ankles of 370 each, 75 kg at a height of 1 m tip over.
    damping : float
        N m s/rad.
    """
    world = World()
    world.add_plane(friction=0.8)
    drive = Drive(stiffness, damping)
    bones = [bone._replace(end=(0.0, bone.end[1], 0.14)) if "shin" in bone.name else bone for bone in BONES]
    person = add_person(world, drive=drive, bones=bones)
    for name, y in (("left", 0.1), ("right", -0.1)):
        foot = world.add_box((0.26, 0.10, 0.06), position=(0.05, y, 0.03), mass=1.0, friction=0.8)
        world.add_ball_joint(person[f"{name} shin"], foot, anchor=(0.0, y, 0.08), drive=drive)
        person[f"{name} foot"] = foot
    return Humanoid(world, person)
