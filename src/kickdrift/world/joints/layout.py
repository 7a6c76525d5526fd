"""Columns of the tables of joints.

A joint holds a frame of body b to a frame of body a along three linear and about three angular axes. Both act at one point,
the anchor of b, so that action and reaction cancel to the last bit of the angular momentum too. Each axis is locked or
open; the *law* of an open one is a row of `JOINT_AXES`: row 6 j + k for axis k of joint j, where axes
0-2 are linear and 3-5 angular.

Joints arrange bodies in articulations: a tree of bodies, each of which hangs on one joint (a *link*), and the joints that
close loops in it. An immovable body ends a tree. For each articulation, `LINK` has first its links, parents before
children, then its closing joints, and after all of them, for one step, bodies without joints that are solved with them: those
that touch a link, up to some contacts away, and those of small heaps that the sweeps have left unsolved (see
`kickdrift.world.direct.unconverged_heaps`). All of them are solved in `kickdrift.world.direct`.
"""

from kickdrift.world.columns import Fields, column
from kickdrift.world.tables import ARTICULATION, GRAPH, JOINT, JOINT_AXES, JOINT_NUMBERS, LINK, LINK_NUMBERS

# Columns of JOINT
JOINT_KIND = column(JOINT)  # place in the catalogue of joints; REMOVED_JOINT for none
BODY_A = column(JOINT)
BODY_B = column(JOINT)
GENERATION = column(JOINT)
LINEAR = column(JOINT)  # how positions are measured, see below
ANGULAR = column(JOINT)  # how angles are
PIVOT = column(JOINT)  # the axis that this refers to
LOCKED = column(JOINT)  # set of axes, bit k for axis k: held for good
LAWS = column(JOINT)  # set of axes: open, and not without force
PRINCIPAL = column(JOINT)  # the axis that is meant where none is named; NONE
GEARED_JOINTS = column(JOINT, 2)  # of gears: rows of JOINT; the gear holds its axis PRINCIPAL
GEARED_AXES = column(JOINT, 2)  # and their axes
REMOVED_JOINT = -1

# Values of LINEAR
FRAME = 0  # along the axes of the frame in a
POINT = 1  # all are locked, and along the world's axes
LINE = 2  # axis 2 points from the anchor of a to that of b; the position along it is their distance less LENGTH
GEARED = 3  # a gear: positions of two axes of other joints times RATES, less LENGTH

# Values of ANGULAR
RIGID = 0  # no axis is open
HINGE = 1  # one is, PIVOT
UNIVERSAL = 2  # two are, PIVOT in a and the next one, cyclically, in b
LOOSE = 3  # three are, without laws
VECTOR = 4  # three are; the angles are the components of the rotation vector
# Three are; swing about axis 0, where the cone is left, and twist about axis 2, the mean of both axes 2
SWING_TWIST = 5

# Columns of JOINT_NUMBERS. Units along and about axes are m and rad, N and N m, and their combinations.
ANCHOR_A = column(JOINT_NUMBERS, 3, "m")  # in the axes of the body
FRAME_A = column(JOINT_NUMBERS, 4)
ANCHOR_B = column(JOINT_NUMBERS, 3, "m")
FRAME_B = column(JOINT_NUMBERS, 4)
LENGTH = column(JOINT_NUMBERS, 1, "m")
BREAKING_FORCE = column(JOINT_NUMBERS, 1, "N")
BREAKING_TORQUE = column(JOINT_NUMBERS, 1, "N m")
TWIST_SCALE = column(JOINT_NUMBERS)  # rotation about axis 2 per twist
# Of the substep along and about the axes, on b; for warm starting
JOINT_IMPULSE = column(JOINT_NUMBERS, 6, "N s, N m s")
TOTAL = column(JOINT_NUMBERS, 6, "N s, N m s")  # impulse of the step; after it, force and torque
# Positions along and angles about the axes; those of hinges and universal joints count turns
JOINT_POSITION = column(JOINT_NUMBERS, 6, "m, rad")
DRIVEN = column(JOINT_NUMBERS, 3, "rad")  # angles less the targets of drives
ARM_A = column(JOINT_NUMBERS, 3, "m")  # from the centres of mass to where the joint acts, in the world's axes
ARM_B = column(JOINT_NUMBERS, 3, "m")
AXES = column(JOINT_NUMBERS, 18)  # linear axes (9), angular axes (9), in the world's axes
MISALIGNMENT = column(JOINT_NUMBERS, 6, "m, rad")  # of locked axes, as it would be after the substep without the joint
SOLVED = column(JOINT_NUMBERS, 6, "N s, N m s")  # the part of JOINT_IMPULSE that was given before the drift
PULL = column(JOINT_NUMBERS, 3, "N s")  # linear impulse of the last substeps, a mean
RATES = column(JOINT_NUMBERS, 2)  # of gears, see `Geared`
BRAKE = column(JOINT_NUMBERS, 3, "N m s")  # of angular axes: damping, see `kickdrift.world.joints.geometric_stiffness`
# Of the first joint of an island: its energy since it was last acted upon, see `kickdrift.world.direct.energy_drift`
ENERGY_AT_FIRST = column(JOINT_NUMBERS, 1, "J")  # kinetic and potential
LAG_AT_FIRST = column(JOINT_NUMBERS, 1, "J")
ENERGY_LEFT = column(JOINT_NUMBERS, 1, "J")  # after the last step
LAG_LEFT = column(JOINT_NUMBERS, 1, "J")
MOST_KINETIC = column(JOINT_NUMBERS, 1, "J")  # zero: not judged in the last step
MEAN_LOSS = column(JOINT_NUMBERS, 1, "J")  # of the last steps
JUDGED_SINCE = column(JOINT_NUMBERS, 1, "s")

# Columns of JOINT_AXES. Zero motors, drives and frictions do nothing; infinite limits are none.
LOWER_LIMIT = column(JOINT_AXES, 1, "m or rad")
UPPER_LIMIT = column(JOINT_AXES, 1, "m or rad")
MOTOR_SPEED = column(JOINT_AXES, 1, "m/s or rad/s")
MOTOR_MAXIMUM = column(JOINT_AXES, 1, "N or N m")
DRIVE_STIFFNESS = column(JOINT_AXES, 1, "N/m or N m/rad")
DRIVE_DAMPING = column(JOINT_AXES, 1, "N s/m or N m s/rad")
TARGET = column(JOINT_AXES, 1, "m or rad")
TARGET_SPEED = column(JOINT_AXES, 1, "m/s or rad/s")
DRIVE_MAXIMUM = column(JOINT_AXES, 1, "N or N m")
JOINT_FRICTION = column(JOINT_AXES, 1, "N or N m")
DRIVEN_MASS = column(JOINT_AXES, 1, "kg or kg m^2")  # that drives are reckoned to move
START_SPEED = column(JOINT_AXES, 1, "m/s or rad/s")  # before the kick
DRIVE_CONSTANT = column(JOINT_AXES, 1, "N s or N m s")  # impulse of the drive in the substep: constant - slope x speed
MOBILITY = column(JOINT_AXES, 1, "1/kg or 1/(kg m^2)")  # speed per impulse of the two bodies alone
DRIVE_SLOPE = column(JOINT_AXES, 1, "kg or kg m^2")

# Columns of ARTICULATION: rows of LINK
FIRST = column(ARTICULATION)  # the first
LINKS = column(ARTICULATION)  # how many links
CLOSINGS = column(ARTICULATION)  # how many closing joints after them
END = column(ARTICULATION)  # row after the last one of them; FIRST while the articulation sleeps
SEQUENTIAL = column(ARTICULATION)  # 1: its joints are solved one after the other, an island that is only judged

# Columns of GRAPH
JOINED_ROWS = column(GRAPH)  # rows of LINK that joints have; after them come bodies that have none
DIRECT_ISLANDS = column(GRAPH)  # rows of ISLAND that are solved directly; after them come those that are not

# Columns of LINK
LINK_BODY = column(LINK)
PARENT = column(LINK)  # a row of LINK, NONE for an immovable body
LINK_JOINT = column(LINK)
SIGN = column(LINK)  # 1 where the body is b of its joint, -1 where it is a
HELD_AXES = column(LINK)  # set of axes whose speed is prescribed in the present system of equations
LINK_A = column(LINK)  # of a closing joint
LINK_B = column(LINK)
ROOT = column(LINK)  # first node of the island; NONE while it sleeps
NODE_ROW = column(LINK)  # of the node in the order of elimination
ISLAND_SIZE = column(LINK)  # of the island, where ROOT is the row itself
ISLAND_ROOM = column(LINK)  # likewise: nodes that it may have
NONE = -1

# Columns of LINK_NUMBERS. Six numbers are three linear and three angular ones in the world's axes, or one per axis.
# 6x6, inertia of the bodies on the joint as it acts on its other side, about the point where the joint acts
ARTICULATED_INERTIA = column(LINK_NUMBERS, 36)
START_WRENCHES = column(LINK_NUMBERS, 24, over=ARTICULATED_INERTIA)  # of gears: four wrenches, before the drift
COUPLING = column(LINK_NUMBERS, 36)  # of open axis k, six numbers: impulse at the joint per speed along the axis
AHEAD_WRENCHES = column(LINK_NUMBERS, 24, over=COUPLING)  # of gears: four wrenches, after the drift
YIELD = column(LINK_NUMBERS, 6, "1/kg, 1/(kg m^2)")  # of open axes: speed per impulse
# Of closing joints: impulse that a solution begins with, less the one that there is
BEGUN = column(LINK_NUMBERS, 6, "N s, N m s", over=YIELD)
BIAS_IMPULSE = column(LINK_NUMBERS, 6, "N s, N m s")  # impulse at the joint if its other side does not move
GAIN = column(LINK_NUMBERS, 6, "m/s, rad/s")  # of velocity: of the body
ACCELERATION = column(LINK_NUMBERS, 6, "m/s^2, rad/s^2")  # of the body, by forces and joints, where it is hit
JOINT_WRENCH = column(LINK_NUMBERS, 6, "N s, N m s")  # impulse at the joint, on the body
RIGHT_HAND_SIDE = column(LINK_NUMBERS, 6, "m/s, rad/s")  # of speed of a held axis that is wanted
PUSH = column(LINK_NUMBERS, 6, "N s, N m s")  # of an open axis: impulse is PUSH - SLOPE times change of speed
SLOPE = column(LINK_NUMBERS, 6, "kg, kg m^2")
AXIS_SPEED = column(LINK_NUMBERS, 6, "m/s, rad/s")  # before the joint acts
LAW_STATE = column(LINK_NUMBERS, 6)  # of a law: which piece of it is assumed
CLOSING_IMPULSE = column(LINK_NUMBERS, 6, "N s, N m s")  # impulse on the body by closing joints
DELTA_SPEED = column(LINK_NUMBERS, 6, "m/s, rad/s")  # change of speed of an open axis
AXIS_IMPULSE = column(LINK_NUMBERS, 6, "N s, N m s")  # impulse on b along and about each axis
PASSING = column(LINK_NUMBERS, 36)  # of open axis k, six numbers: impulse along it per speed of the other side
AXES_AHEAD = column(LINK_NUMBERS, 18)  # AXES and arms as they will be at the end of the substep
ARM_A_AHEAD = column(LINK_NUMBERS, 3, "m")
ARM_B_AHEAD = column(LINK_NUMBERS, 3, "m")
# Of laws: impulse, less the one before the solution, that vertical segments begin with
LAW_BASE = column(LINK_NUMBERS, 6, "N s, N m s")
# Of laws, for the solution that was accepted last: change of speed, and the impulse that bodies bear there
ACCEPTED_DELTA_SPEED = column(LINK_NUMBERS, 6, "m/s, rad/s")
ACCEPTED_IMPULSE = column(LINK_NUMBERS, 6, "N s, N m s")

# Of the law of each axis in a solution: its least and greatest speed, the greatest impulses of friction, of the motor towards
# its speed, and of the drive, whose impulse is the constant less the slope times the speed
_LAW = Fields()
LEAST_SPEED = _LAW.field()
GREATEST_SPEED = _LAW.field()
FRICTION_BOUND = _LAW.field()
MOTOR_BOUND = _LAW.field()
MOTOR_TARGET = _LAW.field()
LAW_CONSTANT = _LAW.field()
LAW_SLOPE = _LAW.field()
DRIVE_BOUND = _LAW.field()
LAW_NUMBERS = _LAW.close()
LAW = column(LINK_NUMBERS, 6 * LAW_NUMBERS)

# Columns of POSE and MOTION, and of everything that has a linear and an angular part
_PARTS = Fields()
LINEAR_PART = _PARTS.field(3)
ANGULAR_PART = _PARTS.field(3)
