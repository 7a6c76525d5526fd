"""Joints of bodies to their parents, with the small bodies between those that follow each other at one body."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.io.robots.bodies import Piece
from kickdrift.io.robots.laws import Actuator, axis_of
from kickdrift.io.robots.parsing import Model
from kickdrift.io.robots.records import Found, record_of
from kickdrift.io.robots.rotors import add_rotor
from kickdrift.world.joints.limits_motors_options import Axis
from kickdrift.world.joints.record import Record
from kickdrift.world.layout import DYNAMIC
from kickdrift.world.shapes.mass_properties import Mass

Floats = NDArray[np.float64]

# Least moment of inertia of a small body, of the least one of the body that it is taken from. It is what the motion is wrong
# by; joints are solved directly, so that a ratio of masses costs digits only.
_SMALL = 1e-4


class Link(NamedTuple):
    """A joint that is to be.

    Attributes
    ----------
    body_a, body_b : int
        MuJoCo's bodies; from ``nbody`` on small ones, ``nbody`` and the joint that moves them.
    record : Record
    names : dict of str to int
        The file's joints that it stands for, and the axis that each of them is.
    """

    body_a: int
    body_b: int
    record: Record
    names: dict[str, int]


class Chain(NamedTuple):
    """How a body hangs at its parent: the joints in their order, and the small bodies between them by their numbers."""

    links: list[Link]
    between: dict[int, Piece]


def chain_of(model: Model, piece: Piece, actuators: dict[str, Actuator], notes: list[str]) -> Chain:
    """Return the links between a body and its parent; floating bodies have none.

    The small bodies and the rotors of motors change the mass of the piece.
    """
    m, kinds = model.compiled, model.mujoco.mjtJoint
    head = piece.members[0]
    rows = list(range(m.body_jntadr[head], m.body_jntadr[head] + m.body_jntnum[head]))
    chain = Chain([], {})
    if not rows:
        return chain
    if int(m.jnt_type[rows[0]]) == kinds.mjJNT_FREE:
        _float(model, piece, rows[0], notes)
        return chain
    single = [row for row in rows if int(m.jnt_type[row]) != kinds.mjJNT_BALL]
    axes = {row: axis_of(model, row, actuators, notes) for row in single}
    runs = _runs(model, rows, axes, notes)
    parent = int(m.body_parentid[head])
    for (record, places), following in zip(runs, [*runs[1:], None], strict=True):
        last = max(places)
        moved, number = piece, head
        if following is not None:
            moved, number = _small(model, piece, min(following[1])), m.nbody + last
            chain.between[number] = moved
            notes.append(
                f"joint {model.name('joint', last)!r} moves a small intermediate body, with {_SMALL:g} of the inertia"
                " of what the joint carries"
            )
        add_rotor(model, last, parent, moved, notes)
        record.placement()  # refuses what no joint is, before anything is added
        chain.links.append(Link(parent, number, record, {model.name("joint", row): at for row, at in places.items()}))
        parent = number
    return chain


def _runs(model: Model, rows: list[int], axes: dict[int, Axis], notes: list[str]) -> list[Found]:
    """Cut joints that follow each other into runs, each as long as one joint here can be."""
    runs: list[Found] = []
    while rows:
        for count in range(len(rows), 0, -1):
            found = record_of(model, rows[:count], axes, notes)
            if found is not None:
                runs.append(found)
                rows = rows[count:]
                break
    return runs


def _small(model: Model, piece: Piece, joint: int) -> Piece:
    """Take a small body out of a piece, at the anchor of the joint between the two.

    The point is one of both, so that where the joint turns, only the moment of inertia is not where it was. The rest of the
    piece has the same mass, centre and inertia together with it; its least moment loses about twice what the small one has.
    """
    m, head = piece.mass, piece.members[0]
    assert m is not None
    at, _ = model.seen_from(head, model.data.xanchor[joint], model.data.xquat[head])
    arm = at - m.centre
    moment = _SMALL * float(np.linalg.eigvalsh(m.inertia)[0])
    mass = moment * m.mass / (moment / _SMALL + m.mass * float(arm @ arm))
    rest = m.mass - mass
    lost = moment * np.eye(3) + m.mass * mass / rest * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    piece.mass = Mass(rest, m.centre - mass / rest * arm, m.inertia - lost)
    return Piece([head], DYNAMIC, Mass(mass, at, moment * np.eye(3)))


def _float(model: Model, piece: Piece, row: int, notes: list[str]) -> None:
    """Take over the damping of what floats, as far as it is one here."""
    m, name, dof = model.compiled, model.name("joint", row), int(model.compiled.jnt_dofadr[row])
    damping = float(m.dof_damping[dof])
    if damping > 0.0 and piece.mass is not None:
        piece.damping = damping / piece.mass.mass
        notes.append(
            f"damping of free joint {name!r} acts here on the velocity of the centre of mass, not on the rotation"
        )
    if m.dof_frictionloss[dof] > 0.0 or m.jnt_stiffness[row] > 0.0:
        notes.append(f"friction and stiffness of free joint {name!r} are left out")
    if m.dof_armature[dof] > 0.0:
        notes.append(f"left out: armature of free joint {name!r}")
