"""Preference between contacts of two faces, with up to four points, and of two edges, with one.

For boxes that rest flat on each other both have the same separation within rounding. Faces win such ties, so that the contact
does not change from step to step.
"""

from kickdrift.core.compilation import compiled

# Square of the sine between two edges below which they are parallel: the adjacent faces give the same axis.
PARALLEL = 1e-6

# The depth of a contact of faces, and the separation along its normal, may differ from that along the best axis by this
# fraction of it plus `tolerance_of`. The depth alone is not enough: where ridges cross, the clipped faces are about as deep.
SHARE_OFF = 0.05
_OF_MARGIN, _OF_THICKNESS = 0.125, 0.01  # 2.5 mm of 20 mm, but no more than a hundredth of a thin body

# Fraction of the tolerance by which corners may be outside the face that clips them, so that those of boxes stacked flush
# remain the same features under rounding.
SLACK = 0.1


@compiled(inline=True)
def tolerance_of(margin: float, thickness: float) -> float:
    """Return the tolerance of the depth of a contact of faces, m, from half of the smaller thickness."""
    return min(_OF_MARGIN * margin, _OF_THICKNESS * thickness)
