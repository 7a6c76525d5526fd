"""Collision detection: the broad phase finds pairs of shapes, the narrow phase their contact points.

Contacts of shapes that may pass each other within a step are found by continuous collision detection. The motion that bodies
are expected to have in a step is that of `predicted_motion`.
"""
