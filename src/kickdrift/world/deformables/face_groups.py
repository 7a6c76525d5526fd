"""Groups of eight triangles of a cloth, in as many of which as possible the corners are consecutive rows of the tables.

Groups are divided into chunks, and these into colours: no two chunks of a colour have a particle in common, so that forces can
be added to their particles in parallel.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.contacts.layout import WIDTH

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

GROUPS_IN_CHUNK = 128
_SHARED = 63  # bits of a word for the colours that several chunks may have; others have a single chunk each
# Of the largest number at rest, to which they are rounded: triangles of a grid differ by rounding errors
_ROUNDING = 2.0**-40


class FaceGroups(NamedTuple):
    """Triangles in groups of eight.

    Attributes
    ----------
    corners : (G, 3, 8) array
    rests : (R, 5, 8) array
        `TO_REST` and `FACE_AREA` of distinct groups; triangles that pad a group have zero area.
    of : (G,) array
        Rows of `rests`.
    in_rows : (G,) array of bool
        Whether the corners of the eight triangles are consecutive.
    apart : (G, 3) array of bool
        In groups of consecutive rows, whether the rows of a corner partly overlap those of another corner and come after them.
    after : (G,) array
        One after the last group of the same colour; groups of a colour follow each other, in chunks of `GROUPS_IN_CHUNK`.
    """

    corners: Integers
    rests: Floats
    of: Integers
    in_rows: NDArray[np.bool_]
    apart: NDArray[np.bool_]
    after: Integers


def face_groups(triangles: Integers, rest: Floats) -> FaceGroups:
    """Divide triangles, (M, 3), with numbers at rest, (M, 5), into groups."""
    largest = np.abs(rest).max(axis=0)
    steps = np.where(largest > 0.0, largest, 1.0) * _ROUNDING
    rounded = np.rint(rest / steps)
    shapes = np.concatenate((triangles[:, 1:] - triangles[:, :1], rounded), axis=1)
    kinds = np.unique(shapes, axis=0, return_inverse=True)[1].ravel()
    order = np.lexsort((triangles[:, 0], kinds))
    follows = (np.diff(kinds[order]) == 0) & (np.diff(triangles[order, 0]) == 1)
    begins = np.flatnonzero(np.concatenate(([True], ~follows)))
    counts = np.diff(np.append(begins, len(order)))
    within = np.arange(len(order)) - np.repeat(begins, counts)
    full = within < np.repeat(counts // WIDTH * WIDTH, counts)
    rows, others = order[full], order[~full]
    filled = np.concatenate((others, np.repeat(others[-1:], -len(others) % WIDTH)))
    members = np.concatenate((rows, filled)).reshape(-1, WIDTH)
    numbers = rounded[members] * steps
    numbers.reshape(-1, 5)[len(order) :, 4] = 0.0
    rests, of = np.unique(numbers.transpose(0, 2, 1).reshape(len(members), -1), axis=0, return_inverse=True)
    in_rows = np.arange(len(members)) < len(rows) // WIDTH
    firsts = np.repeat(triangles[order[begins], 0], counts)[full][::WIDTH]
    # Adjacent ranges of consecutive triangles one after the other
    near = np.argsort(np.append(firsts, triangles[members[len(firsts) :, 0], 0]), kind="stable")
    colours = _colours(triangles[members[near]].reshape(len(members), -1))
    near = near[np.argsort(colours, kind="stable")]
    corners = triangles[members].transpose(0, 2, 1)[near]
    beyond = corners[:, :, None, 0] - corners[:, None, :, 0]
    apart = ((beyond > 0) & (beyond < WIDTH)).any(axis=2) & in_rows[near, None]
    after = np.searchsorted(np.sort(colours), np.sort(colours), side="right")
    return FaceGroups(corners, rests.reshape(-1, 5, WIDTH), of.ravel()[near], in_rows[near], apart, after)


def _colours(particles: Integers) -> Integers:
    """Return the colours of groups with these particles, (G, 24), one for each chunk of consecutive groups.

    A chunk gets the rarest colour that no chunk with a common particle has; a new one where all are taken.
    """
    colours, taken = np.zeros(len(particles), dtype=np.int64), np.zeros(particles.max() + 1, dtype=np.uint64)
    counts: list[int] = []
    for begin in range(0, len(particles), GROUPS_IN_CHUNK):
        own = np.unique(particles[begin : begin + GROUPS_IN_CHUNK])
        near = int(np.bitwise_or.reduce(taken[own]))
        free = [k for k in range(min(len(counts), _SHARED)) if not near >> k & 1]
        colour = min(free, key=counts.__getitem__, default=len(counts))
        if colour == len(counts):
            counts.append(0)
        if colour < _SHARED:
            taken[own] |= np.uint64(1 << colour)
        counts[colour] += 1
        colours[begin : begin + GROUPS_IN_CHUNK] = colour
    return colours
