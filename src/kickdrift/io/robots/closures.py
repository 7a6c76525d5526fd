"""Joints that close loops, and bodies that never touch."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.io.robots.bodies import Piece
from kickdrift.io.robots.joints import Link
from kickdrift.io.robots.parsing import Model
from kickdrift.world.joints.ball import Ball
from kickdrift.world.joints.fixed import Fixed

Floats = NDArray[np.float64]

_OPEN = 1e-6  # m or rad, what a loop may be open by at the reference pose: files are written with six digits


def closures(model: Model, notes: list[str]) -> list[Link]:
    """Make joints of the constraints that hold bodies together.

    Raises
    ------
    ArgumentError
        For one that is not fulfilled at the reference pose.
    """
    m, kinds = model.compiled, model.mujoco.mjtEq
    made = []
    for row in range(m.neq):
        name, kind = model.name("eq", row), m.eq_type[row]
        if not m.eq_active0[row]:
            notes.append(f"constraint {name!r} is left out: it is not active")
        elif not model.is_one_of(kind, kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
            notes.append(f"constraint {name!r} is left out: it neither connects nor welds two bodies")
        elif len(set(m.body_weldid[_bodies(model, row)[0]].tolist())) == 1:
            notes.append(f"constraint {name!r} is left out: its bodies are fixed to each other")
        else:
            made.append((_connect if model.is_one_of(kind, kinds.mjEQ_CONNECT) else _weld)(model, row, name))
    return made


def _bodies(model: Model, row: int) -> tuple[list[int], list[tuple[Floats, Floats]]]:
    """Return the two bodies of a constraint, and the places of the objects that it refers to: they or sites of them."""
    m, d = model.compiled, model.data
    objects = [int(m.eq_obj1id[row]), int(m.eq_obj2id[row])]
    if _of_sites(model, row):
        places = [(d.site_xpos[site], d.site_xmat[site].reshape(3, 3)) for site in objects]
        return [int(m.site_bodyid[site]) for site in objects], places
    return objects, [(d.xpos[body], d.xmat[body].reshape(3, 3)) for body in objects]


def _of_sites(model: Model, row: int) -> bool:
    return model.is_one_of(model.compiled.eq_objtype[row], model.mujoco.mjtObj.mjOBJ_SITE)


def _connect(model: Model, row: int, name: str) -> Link:
    """Hold a point of one body to one of the other."""
    (a, b), places = _bodies(model, row)
    anchors = np.zeros((2, 3)) if _of_sites(model, row) else model.compiled.eq_data[row, :6].reshape(2, 3)
    points = [place + turn @ anchor for (place, turn), anchor in zip(places, anchors, strict=True)]
    _check(name, float(np.linalg.norm(points[0] - points[1])), "m")
    return Link(a, b, Ball(model.point(points[0])), {name: -1})


def _weld(model: Model, row: int, name: str) -> Link:
    """Hold a body to the other as it is in the file: with its origin or site, and its axes."""
    (a, b), ((place_a, turn_a), (place_b, turn_b)) = _bodies(model, row)
    if _of_sites(model, row):
        _check(name, float(np.linalg.norm(place_a - place_b)), "m")
        _check(name, float(np.linalg.norm(turn_a - turn_b)), "rad")
        return Link(a, b, Fixed(model.point(place_a)), {name: -1})
    # The point `anchor` of body 2 and the point `position` of body 1 are one, and body 2 is turned by `turn` in body 1.
    anchor, position, turn, _ = np.split(model.compiled.eq_data[row], (3, 6, 10))
    held = place_b + turn_b @ anchor
    _check(name, float(np.linalg.norm(place_a + turn_a @ position - held)), "m")
    _check(name, float(np.linalg.norm(turn_a @ model.matrix(turn) - turn_b)), "rad")
    return Link(a, b, Fixed(model.point(held)), {name: -1})


def _check(name: str, gap: float, unit: str) -> None:
    if gap > _OPEN:
        raise ArgumentError(
            f"constraint {name!r} is violated by {gap:.3g} {unit} in the file's reference pose, but a joint keeps"
            " bodies as they are placed there; move them so that the constraint is satisfied."
        )


def exclusions(model: Model, parts: list[Piece], notes: list[str]) -> list[tuple[int, int]]:
    """Return pairs of MuJoCo's bodies, first members of pieces, that never touch: excluded ones, and children and parents."""
    m = model.compiled
    first = {body: piece.members[0] for piece in parts for body in piece.members}
    several = {piece.members[0] for piece in parts if sum(m.body_geomnum[body] > 0 for body in piece.members) > 1}
    pairs = []
    if not m.opt.disableflags & model.mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
        for head in (piece.members[0] for piece in parts):
            parent = int(m.body_parentid[head])
            if m.body_weldid[head] and m.body_weldid[parent]:
                pairs.append((head, int(m.body_weldid[parent])))
            elif m.body_weldid[head] and parent and model.is_urdf:
                pairs.append((head, parent))  # in MJCF, what is fixed to the world is part of it and touches all
    for signature in m.exclude_signature.tolist():
        pair = (first[signature >> 16], first[signature & 0xFFFF])
        pairs.append(pair)
        if several & set(pair):
            notes.append(f"exclude of {model.named('body', pair)} also applies to everything fixed to them")
    return pairs
