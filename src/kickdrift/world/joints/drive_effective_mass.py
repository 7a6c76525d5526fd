"""The effective mass along an axis of a joint."""

import numpy as np

from kickdrift.world.integration import follow_pose
from kickdrift.world.joints.layout import ARM_A, ARM_B, AXES, BODY_A, BODY_B, LOCKED
from kickdrift.world.layout import BODY_KIND, DYNAMIC
from kickdrift.world.tables import BODY, INVERSE_MASS, JOINT, JOINT_NUMBERS, Tables


def effective_mass(tables: Tables, joint: int, axis: int) -> float:
    """Return the effective mass, kg or kg m^2, of a measured joint along an open axis, with its locked axes held.

    Zero if neither body can move along it.
    """
    row, numbers = tables.array(JOINT)[joint], tables.array(JOINT_NUMBERS)[joint]
    bodies = tables.array(BODY)
    axes = numbers[AXES : AXES + 18].reshape(6, 3)
    locked = [k for k in range(6) if int(row[LOCKED]) >> k & 1]
    mobility = np.zeros((6, 6))
    for body, arm in ((row[BODY_A], ARM_A), (row[BODY_B], ARM_B)):
        if bodies[body, BODY_KIND] == DYNAMIC:
            follow_pose(tables.address, body)  # users may have turned it
        inverse_mass, xx, yy, zz, xy, xz, yz = tables.array(INVERSE_MASS)[body, :7]
        inverse_inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        turns = np.vstack((np.cross(numbers[arm : arm + 3], axes[:3]), axes[3:]))
        pushes = np.vstack((axes[:3], np.zeros((3, 3))))
        mobility += inverse_mass * pushes @ pushes.T + turns @ inverse_inertia @ turns.T
    held = mobility[np.ix_(locked, locked)]
    free = mobility[axis, axis] - mobility[axis, locked] @ np.linalg.pinv(held, hermitian=True) @ mobility[locked, axis]
    return float(1.0 / free) if free > 1e-12 * mobility[axis, axis] else 0.0
