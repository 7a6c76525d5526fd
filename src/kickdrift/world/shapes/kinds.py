"""Kinds of shapes, in the order in which the two of a contact stand."""

PLANE = 0
TRIANGLE = 1  # one of a mesh
SPHERE = 2
CAPSULE = 3
BOX = 4
HULL = 5
MESH = 6
