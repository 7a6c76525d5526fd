"""What decides between contacts of two faces, with up to four points, and of two edges, with one.

Boxes at rest on each other lie flat but for rounding, and then both say the same within a little. Faces win such
ties, so that the contact stays what it is from step to step.
"""

from kickdrift.core.compilation import compiled

# Square of the sine between two edges, below which the faces beside them tell all that they do.
PARALLEL = 1e-6

# A contact of faces may be off the depth along the best axis by this share of it and by `tolerance_of`.
SHARE_OFF = 0.05
_OF_MARGIN, _OF_THICKNESS = 0.125, 0.01  # 2.5 mm of 20 mm, but no more than a hundredth of a thin body

# Part of that by which corners may be outside of the face that they are clipped by: those of boxes that are stacked
# flush stay the same features while they tremble by rounding.
SLACK = 0.1


@compiled(inline=True)
def tolerance_of(margin: float, thickness: float) -> float:
    """Return by how much a contact of faces may be off the best axis, m, given half of the smaller thickness."""
    return min(_OF_MARGIN * margin, _OF_THICKNESS * thickness)
