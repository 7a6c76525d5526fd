"""Features of a file that are left out."""

import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from kickdrift.io.robots.parsing import Model

# Arrays of a model that ask for something where they are not zero: kind of the rows, and what it is.
_NONZERO = {
    "dof_dampingpoly": ("joint", "damping beyond the linear term"),
    "jnt_stiffnesspoly": ("joint", "stiffness beyond the linear term"),
    "jnt_springyield": ("joint", "yielding springs"),
    "jnt_actgravcomp": ("joint", "gravity compensation by actuators"),
    "body_gravcomp": ("body", "gravity compensation"),
    "geom_adhesion": ("geom", "adhesion"),
    "geom_surfacevel": ("geom", "surface velocity"),
    "geom_fluid": ("geom", "fluid forces"),
    "actuator_armature": ("actuator", "armature"),
    "actuator_damping": ("actuator", "damping"),
}

# Counts of a model, and what they count.
_COUNTS = {
    "ntendon": "tendons, and everything that acts through them",
    "nflex": "flexible bodies",
    "npair": "contact pairs with their own parameters",
    "nplugin": "plugins",
}

_OVERLAP = 1e-3  # m

_NAME = re.compile(r"([^']*)('[^']*')(.*)", re.DOTALL)


def omissions(model: Model) -> list[str]:
    """List what is left out."""
    m, notes = model.compiled, []
    for array, (kind, what) in _NONZERO.items():
        values = getattr(m, array, None)  # some came with later versions of MuJoCo
        if values is None or not np.any(values):
            continue
        rows = np.flatnonzero(np.reshape(values, (len(values), -1)).any(axis=1))
        if array.startswith("dof_"):
            rows = np.unique(m.dof_jntid[rows])
        notes.append(f"left out: {what}, of {kind} {model.named(kind, rows)}")
    notes += [f"left out: {what}, {getattr(m, count)} of them" for count, what in _COUNTS.items() if getattr(m, count)]
    if m.opt.density or m.opt.viscosity:
        notes.append("left out: the medium, with its wind, density and viscosity")
    return notes + _actuators(model) + _friction(m, model)


def overlaps(model: Model, apart: Iterable[tuple[int, int]]) -> list[str]:
    """List bodies that overlap in the reference pose, but for pairs that never touch."""
    m, d = model.compiled, model.data
    model.mujoco.mj_collision(m, d)
    deepest: dict[tuple[int, int], float] = {}
    for contact in d.contact[: d.ncon]:
        a, b = sorted(int(m.body_weldid[body]) or int(body) for body in m.geom_bodyid[contact.geom])
        deepest[a, b] = min(deepest.get((a, b), 0.0), float(contact.dist))
    left_out = {tuple(sorted(pair)) for pair in apart}
    return [
        f"bodies {model.named('body', pair)} overlap by {-depth:.2g} m in the reference pose and will push each other"
        " apart; move or exclude them"
        for pair, depth in deepest.items()
        if depth < -_OVERLAP and pair not in left_out
    ]


def gathered(notes: list[str]) -> tuple[str, ...]:
    """Merge notes that differ in one name, the first that they mention."""
    names: dict[tuple[str, ...], list[str]] = {}
    for note in notes:
        found = _NAME.match(note)
        before, name, after = found.groups() if found else (note, "", "")
        of_same = names.setdefault((before, after), [])
        of_same += [name] * (name not in of_same)
    return tuple(
        before + first + after + ("; likewise " + ", ".join(others) if others else "")
        for (before, after), (first, *others) in names.items()
    )


def _actuators(model: Model) -> list[str]:
    kinds, m = model.mujoco.mjtTrn, model.compiled
    turns = (model.mujoco.mjtJoint.mjJNT_HINGE, model.mujoco.mjtJoint.mjJNT_SLIDE)
    left = []
    for k in range(m.nu):
        of_joint = model.is_one_of(m.actuator_trntype[k], kinds.mjTRN_JOINT, kinds.mjTRN_JOINTINPARENT)
        if not (of_joint and model.is_one_of(m.jnt_type[m.actuator_trnid[k, 0]], *turns)):
            left.append(k)
    return [f"left out: actuators that drive no hinge or slide, {model.named('actuator', left)}"] if left else []


def _friction(m: Any, model: Model) -> list[str]:
    touching = (m.geom_contype != 0) | (m.geom_conaffinity != 0)
    notes = []
    if np.unique(m.geom_friction[touching, 0]).size > 1:
        notes.append(
            "geoms differ in friction: two in contact have the geometric mean here, but in MuJoCo the larger one or"
            " that of higher priority"
        )
    twisting = np.flatnonzero(touching & (m.geom_condim >= 4))
    if twisting.size:
        notes.append(f"left out: torsional friction (condim 4 and 6) of geom {model.named('geom', twisting)}")
    return notes
