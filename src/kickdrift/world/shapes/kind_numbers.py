"""Numbers of the kinds of shapes, in the order in which the two of a contact stand; each has a record in its file."""

PLANE = 0
TRIANGLE = 1  # one of a surface
SPHERE = 2
CAPSULE = 3
BOX = 4
HULL = 5
MESH = 6
HEIGHT_FIELD = 7
CYLINDER = 8
CONE = 9
