"""Armature: the inertia of a motor's rotor against the relative motion of the two bodies of a joint."""

import numpy as np

from kickdrift.io.robots.bodies import Piece
from kickdrift.io.robots.parsing import Model


def add_rotor(model: Model, joint: int, parent: int, moved: Piece, notes: list[str]) -> None:
    """Give what a joint moves the inertia of its rotor, about the axis.

    MuJoCo's rotors have the energy a q'^2 / 2, where q' is the rate of the joint. That is the energy which the inertia
    a n n^T adds to a body that turns about n, as long as the parent does not turn about it too.

    Parameters
    ----------
    model : Model
    joint : int
        Of MuJoCo.
    parent : int
        Body that it holds to: one of MuJoCo's, or a number from ``nbody`` on.
    moved : Piece
        What it moves.
    notes : list of str
    """
    m, kinds = model.compiled, model.mujoco.mjtJoint
    armature, name = float(m.dof_armature[m.jnt_dofadr[joint]]), model.name("joint", joint)
    if armature == 0.0 or moved.mass is None:
        return
    fixed = model.is_fixed(parent)
    axes = model.matrix(model.data.xquat[moved.members[0]])
    n = axes.T @ model.data.xaxis[joint]
    if int(m.jnt_type[joint]) == kinds.mjJNT_SLIDE:
        if fixed and abs(model.data.xaxis[joint] @ m.opt.gravity) <= 1e-6 * np.linalg.norm(m.opt.gravity):
            moved.mass = moved.mass._replace(mass=moved.mass.mass + armature)
            notes.append(f"armature of joint {name!r} is added to the mass of what it moves")
        else:
            notes.append(
                f"left out: armature of joint {name!r}, which slides against gravity, or relative to a moving body"
            )
        return
    about = np.eye(3) if int(m.jnt_type[joint]) == kinds.mjJNT_BALL else np.outer(n, n)
    moved.mass = moved.mass._replace(inertia=moved.mass.inertia + armature * about)
    if not fixed:
        notes.append(
            f"armature of joint {name!r} is added to the inertia of what it moves, so that it also resists rotation of"
            " the parent"
        )
