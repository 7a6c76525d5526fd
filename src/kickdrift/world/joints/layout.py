"""Columns of the tables that joints live in.

A joint holds a frame of body b to a frame of body a along three linear and about three angular axes. Both act at one point,
the anchor of b, so that action and reaction cancel to the last bit of the angular momentum too. Each axis is locked or
open; what happens along an open one, its *law*, is a row of `JOINT_AXES`: row 6 j + k for axis k of joint j, where axes
0-2 are linear and 3-5 angular.

Joints arrange bodies in articulations: a tree of bodies, each of which hangs on one joint (a *link*), and the joints that
close loops in it. A body that nothing moves ends a tree. `LINK` holds of each articulation first its links, parents before
children, then its closing joints, and after all of them, for one step, free bodies that touch a link. All of them are solved
in `kickdrift.world.direct`.

Columns at which vectors begin are of type int64: for each plain integer that it is called with, Numba compiles a function
anew.
"""

from collections.abc import Callable

import numpy as np

int64: Callable[[int], int] = np.int64  # type: ignore[assignment]  # an int that is no literal: functions compile once for all

# Columns of JOINT
JOINT_KIND, BODY_A, BODY_B, GENERATION = 0, 1, 2, 3  # place in the catalogue of joints; REMOVED where there is none
LINEAR, ANGULAR, PIVOT = 4, 5, 6  # how positions and angles are measured, see below, and the axis that this refers to
LOCKED, LAWS = 7, 8  # sets of axes, bit k for axis k: held for good; open, and not without force
BROKEN = 9
PRINCIPAL = 10  # the axis that is meant where none is named; NONE
GEARED_JOINTS, GEARED_AXES = 11, 13  # of gears: two rows of JOINT, and their axes; the gear holds its axis PRINCIPAL
REMOVED = -1

# Values of LINEAR
FRAME = 0  # along the axes of the frame in a
POINT = 1  # all are locked, and along the world's axes
LINE = 2  # axis 2 points from the anchor of a to that of b; the position along it is their distance less LENGTH
GEARED = 3  # a gear: positions of two axes of other joints times RATES, less LENGTH

# Values of ANGULAR
RIGID = 0  # no axis is open
HINGE = 1  # one is, PIVOT
UNIVERSAL = 2  # two are, PIVOT in a and the next one, cyclically, in b
LOOSE = 3  # three are, and no law is asked for
VECTOR = 4  # three are; the angles are the components of the rotation vector
SWING_TWIST = (
    5  # three are; swing about axis 0, where the cone is left, and twist about axis 2, the mean of both axes 2
)

# Columns of JOINT_NUMBERS
ANCHOR_A, FRAME_A = int64(0), int64(3)  # in the axes of the body: point, quaternion
ANCHOR_B, FRAME_B = int64(7), int64(10)
LENGTH = 14
BREAKING_FORCE, BREAKING_TORQUE = 15, 16
TWIST_SCALE = 17  # rotation about axis 2 per twist
JOINT_IMPULSE = int64(18)  # of the substep along and about the axes, on b; what a warm start gives
TOTAL = int64(24)  # impulse of the step; after it, force and torque
JOINT_POSITION = int64(
    30
)  # positions along and angles about the axes; those of hinges and universal joints count turns
DRIVEN = int64(36)  # angles less the targets of drives
ARM_A, ARM_B = int64(39), int64(42)  # from the centres of mass to where the joint acts, in the world's axes
AXES = int64(45)  # linear axes (9), angular axes (9), in the world's axes
MISALIGNMENT = int64(63)  # of locked axes, as it would be at the end of the substep were the joint to do nothing
PULL = int64(75)  # linear impulse of the last substeps, a mean
SOLVED = int64(69)  # the part of JOINT_IMPULSE that was given before the drift
RATES = 78  # of gears: two, see `Geared`

# Columns of JOINT_AXES. Zero motors, drives and frictions do nothing; infinite limits are none.
LOWER_LIMIT, UPPER_LIMIT = 0, 1
MOTOR_SPEED, MOTOR_MAXIMUM = 2, 3
DRIVE_STIFFNESS, DRIVE_DAMPING, TARGET, TARGET_SPEED, DRIVE_MAXIMUM = 4, 5, 6, 7, 8
JOINT_FRICTION = 9
DRIVEN_MASS = 10  # that drives are reckoned to move
START_SPEED = 11  # before the kick
DRIVE_CONSTANT, DRIVE_SLOPE = 12, 14  # of the substep: impulse of the drive is constant - slope x speed
MOBILITY = 13  # speed per impulse of the two bodies alone

# Columns of ARTICULATION
FIRST, LINKS, CLOSINGS = 0, 1, 2  # rows of LINK: the first, how many links, how many closing joints after them
END = 3  # row of LINK after the last one of them; FIRST while the articulation sleeps
SEQUENTIAL = 6  # 1: its joints are solved one after the other, and its bodies are no nodes

# Columns of GRAPH
JOINED_ROWS = 0  # rows of LINK that joints have; after them come free bodies that are solved directly in this step

# Columns of LINK
LINK_BODY, PARENT, LINK_JOINT = 0, 1, 2  # PARENT is a row of LINK, NONE for one that nothing moves
SIGN = 3  # 1 where the body is b of its joint, -1 where it is a
HELD_AXES = 4  # set of axes whose speed is prescribed in the system of equations at hand
LINK_A, LINK_B = 5, 6  # of a closing joint
ROOT = 7  # first node of the island; NONE while it sleeps
NODE_ROW = 8  # of the node in the order of elimination
ISLAND_SIZE = 9  # of the island, where ROOT is the row itself
NONE = -1

# Columns of LINK_NUMBERS. Six numbers are three linear and three angular ones in the world's axes, or one to each axis.
ARTICULATED_INERTIA = (
    0  # 6x6, of what hangs on the joint, as its other side feels it, about the point where the joint acts
)
START_WRENCHES, AHEAD_WRENCHES = int64(0), int64(36)  # of gears: four wrenches, before and after the drift
COUPLING = int64(36)  # of open axis k, six numbers: impulse at the joint per speed along the axis
YIELD = 72  # of open axes: speed per impulse
BIAS_IMPULSE = int64(78)  # impulse at the joint if its other side stays as it is
BEGUN = 72  # of closing joints: impulse that a solution begins with, less the one that there is
GAIN = int64(84)  # of velocity: of the body
JOINT_WRENCH = int64(90)  # impulse at the joint, on the body
RIGHT_HAND_SIDE = 96  # of speed of a held axis that is wanted
PUSH, SLOPE = 102, 108  # of an open axis: impulse is PUSH - SLOPE times change of speed
AXIS_SPEED = 114  # before the joint acts
LAW_STATE = 120  # of a law: which piece of it is assumed
CLOSING_IMPULSE = 126  # impulse on the body by closing joints
DELTA_SPEED = 132  # change of speed of an open axis
AXIS_IMPULSE = int64(138)  # impulse on b along and about each axis
PASSING = int64(144)  # of open axis k, six numbers: impulse along it per speed of the other side
AXES_AHEAD = int64(180)  # AXES and arms as they will be at the end of the substep
ARM_A_AHEAD, ARM_B_AHEAD = int64(198), int64(201)
BRAKE = 204  # of open angular axes: damping, impulse per speed; see `kickdrift.world.joints.brakes`
LAW_BASE = 222  # of laws: impulse, less the one before the solution, that upright pieces begin with
# Of laws, for the solution that was accepted last: change of speed, and the impulse that bodies bear there
ACCEPTED_DELTA_SPEED, ACCEPTED_IMPULSE = 228, 234

# Columns of POSE, MOTION and INVERSE_MASS, and of everything that has a linear and an angular part
LINEAR_PART, ANGULAR_PART = int64(0), int64(3)
INVERSE_INERTIA_PART = int64(1)  # of INVERSE_MASS
