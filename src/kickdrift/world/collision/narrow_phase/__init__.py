"""The narrow phase: the contact points of each pair of kinds of shapes.

A contact function of a pair of kinds, ``collide(a, b, pose, margin, manifold)``, gets the numbers of two shapes, the pose of
the second in the frame of the first (7) and the largest separation of points, m, zero or positive. It writes the unit normal
from the first shape to the second, in the first's frame, and for up to four points their positions on the first shape in its
frame and on the second in its own, and an id that persists while the same features touch (`kickdrift.world.contacts.layout`).
It returns the number of points. Polyhedra read from the manifold the gap up to which points may touch before they are found
again, and write the smallest gap of those that they left out. Separations are normal . (point on b - point on a), negative if
the shapes overlap.
"""
