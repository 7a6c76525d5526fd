"""Robots from MJCF and URDF files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.core.interruption import InterruptionNoted
from kickdrift.io.robots.bodies import Piece, add_piece, pieces
from kickdrift.io.robots.closures import closures, exclusions
from kickdrift.io.robots.geoms import Layers
from kickdrift.io.robots.joints import Link, chain_of
from kickdrift.io.robots.laws import Actuator
from kickdrift.io.robots.omissions import gathered, omissions, overlaps
from kickdrift.io.robots.parsing import Model, parse
from kickdrift.world.argument_checks import unit_quaternion, vector
from kickdrift.world.bodies.handle import Body
from kickdrift.world.collision.broad_phase.filters_and_sensors import exclude
from kickdrift.world.joints.handle import Joint
from kickdrift.world.layout import LAYER, STATIC
from kickdrift.world.settings import GRAVITY
from kickdrift.world.tables import ASKED_APART, SETTINGS, SHAPE
from kickdrift.world.world import World


class Robot(NamedTuple):
    """A robot in a world.

    Attributes
    ----------
    world : World
    bodies : mapping of str to Body
        By their names in the file; bodies fixed to each other are one, and bodies fixed to the world are static.
    joints : mapping of str to Joint
        By their names in the file; several hinges and slides on one body may be one joint. Floating bodies have none.
    axes : mapping of str to int
        Which axis of its joint each of the file's joints is, for ``Joint.angles``, ``Joint.set_drive`` and the like;
        -1 for ball joints.
    closures : mapping of str to Joint
        Ball joints and fixed joints that close loops, by the names of the file's constraints.
    actuators : mapping of str to Actuator
        Motors and servos. Servos begin as drives of their joints, with control zero.
    between : mapping of str to Body
        Small intermediate bodies, for joints of one body that no single joint here represents, by the names of the joints
        that move them.
    notes : tuple of str
        Features of the file that are left out or treated differently here.
    """

    world: World
    bodies: Mapping[str, Body]
    joints: Mapping[str, Joint]
    axes: Mapping[str, int]
    closures: Mapping[str, Joint]
    actuators: Mapping[str, Actuator]
    between: Mapping[str, Body]
    notes: tuple[str, ...]


def load_robot(
    path: str | Path,
    world: World | None = None,
    *,
    position: ArrayLike = (0.0, 0.0, 0.0),
    orientation: ArrayLike = (1.0, 0.0, 0.0, 0.0),
    floating: bool = False,
    folder: str | Path | None = None,
) -> Robot:
    """Read a robot from an MJCF or URDF file into a world, in the reference pose of the file.

    Parameters
    ----------
    path : path
        MuJoCo parses and compiles it. Nothing in it is executed.
    world : World, optional
        The world to add it to; by default a new one with the gravity of the file.
    position : (3,) array_like
        Of the file's origin in the world, m.
    orientation : (4,) array_like
        Quaternion (w, x, y, z) that turns the file's axes into the world's.
    floating : bool
        Whether the root of a URDF file moves freely, rather than being fixed to the world; MJCF files specify this
        themselves.
    folder : path, optional
        The folder within which the file may refer to others, such as its package; by default the folder of the file.

    Returns
    -------
    Robot
        The world, bodies, joints and actuators by name, and notes on everything that differs from the file.

    Raises
    ------
    MissingExtraError
        If MuJoCo is not installed: ``pip install 'kickdrift[robots]'``.
    FileFormatError
        If there is no such file, it refers to others outside the folder, or MuJoCo cannot read it.
    ArgumentError
        For joints, shapes and masses that kickdrift does not support. The world is then unchanged.

    Notes
    -----
    Contacts, limits and constraints are those of the world: rigid, and without the ``solref``, ``solimp`` and ``margin`` of
    the file. Geoms with contype and conaffinity zero and the visuals of links are drawn, meshes as their convex hulls;
    nothing collides with them, nor do rays hit them, but their mass counts. Bodies do not collide with their parents or with
    excluded bodies. Angles are zero in the reference pose; keyframes, sensors, cameras and lights are ignored.

    Joints of one body that no single joint here represents get small intermediate bodies, whose mass is taken from it.
    Rotors (``armature``) add inertia about the axis to what their joint moves, which equals MuJoCo's model if the parent
    does not turn about it.

    Examples
    --------
    >>> from pathlib import Path
    >>> import kickdrift as kd
    >>> inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    >>> link = f'<link name="%s"><inertial><mass value="1"/>{inertia}</inertial></link>'
    >>> ends = '<parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>'
    >>> joint = f'<joint name="elbow" type="continuous">{ends}</joint>'
    >>> _ = Path("arm.urdf").write_text(
    ...     f"<robot name='arm'>{link % 'base'}{link % 'arm'}{joint}</robot>"
    ... )
    >>> robot = kd.load_robot("arm.urdf")
    >>> list(robot.joints)
    ['elbow']
    """
    if world is not None and not isinstance(world, World):
        raise ArgumentError(f"world={world!r} is not a world; give a kickdrift.World, or None for a new one.")
    if not isinstance(folder, str | Path | None):
        raise ArgumentError(f"folder={folder!r} is not a path; give the path of a folder, or None.")
    place, turn = vector("position", position, 3), unit_quaternion("orientation", orientation)
    model, notes = parse(path, floating, place, turn, folder)
    notes += omissions(model)
    used = 0 if world is None else int(np.bitwise_or.reduce(world.tables.array(SHAPE)[:, LAYER], initial=0))
    actuators: dict[str, Actuator] = {}
    try:
        parts = pieces(model, Layers(model, used), notes)
        chains = [chain_of(model, part, actuators, notes) for part in parts]
        closing = closures(model, notes)
    except ArgumentError as error:
        raise ArgumentError(f"path={str(path)!r}: {error}") from None
    pairs = exclusions(model, parts, notes)
    notes += overlaps(model, pairs)
    links = [link for chain in chains for link in chain.links]
    small = {number: piece for chain in chains for number, piece in chain.between.items()}
    world = _world(model, world, notes)
    with world.tables.lock, InterruptionNoted(passed_on=True):
        bodies = _add_bodies(world, model, parts)
        names = {model.name("body", row): body for row, body in bodies.items()}
        _exclude(world, [(bodies[a], bodies[b]) for a, b in pairs])
        bodies |= {number: add_piece(world, model, piece) for number, piece in small.items()}
        joints = _add_joints(world, model, links, bodies)
        closed = _add_joints(world, model, closing, bodies)
    axes = {name: axis for link in links for name, axis in link.names.items()}
    return Robot(
        world=world,
        bodies=MappingProxyType(names),
        joints=MappingProxyType(joints),
        axes=MappingProxyType(axes),
        closures=MappingProxyType(closed),
        actuators=MappingProxyType(actuators),
        between=MappingProxyType(
            {model.name("joint", number - model.compiled.nbody): bodies[number] for number in small}
        ),
        notes=gathered(notes),
    )


def _world(model: Model, world: World | None, notes: list[str]) -> World:
    """Create a world with the file's gravity, or note that the given one has another."""
    off = model.compiled.opt.disableflags & model.mujoco.mjtDisableBit.mjDSBL_GRAVITY
    gravity = np.zeros(3) if off else np.array(model.compiled.opt.gravity)
    if world is None:
        return World(gravity=gravity)
    there = world.tables.array(SETTINGS)[0, GRAVITY : GRAVITY + 3]
    if not np.array_equal(there, gravity):
        notes.append(f"gravity is {there.tolist()} m/s^2, as in the given world, not {gravity.tolist()} as in the file")
    return world


def _add_bodies(world: World, model: Model, parts: list[Piece]) -> dict[int, Body]:
    """Add all bodies; of those that are fixed to the world, the ones that have shapes or are drawn."""
    bodies: dict[int, Body] = {}
    for part in parts:
        body = (
            world.ground if part.kind == STATIC and not (part.shapes or part.shown) else add_piece(world, model, part)
        )
        bodies |= dict.fromkeys(part.members, body)
    return bodies


def _exclude(world: World, pairs: list[tuple[Body, Body]]) -> None:
    """Add to the pairs of bodies that never touch; the ground stands for those that have no shapes."""
    new = [(a.index, b.index) for a, b in pairs if world.ground not in (a, b)]
    exclude(world.tables, [*map(tuple, world.tables.array(ASKED_APART).tolist()), *new])


def _add_joints(world: World, model: Model, links: list[Link], bodies: dict[int, Body]) -> dict[str, Joint]:
    """Add joints; those to bodies that are fixed to the world hold to the ground."""
    joints: dict[str, Joint] = {}
    for a, b, record, names in links:
        ends = [world.ground if model.is_fixed(body) else bodies[body] for body in (a, b)]
        joints |= dict.fromkeys(names, world.add_joint(ends[0], ends[1], record))
    return joints
