"""Checks of the tables of cloths read from a file, since compiled code trusts every index in them."""

import numpy as np

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.self_collision.closest_features import VERTEX_FACE
from kickdrift.world.deformables.self_collision.untangling import CROSSING
from kickdrift.world.layout import BODY_KIND, REMOVED
from kickdrift.world.table_checks import FileTables

_RANGES = (
    ("PARTICLE", c.FIRST_PARTICLE), ("FACE", c.FIRST_FACE), ("COUPLING", c.FIRST_COUPLING), ("CURVED_FACE", c.FIRST_CURVED),
    ("PIN", c.FIRST_PIN), ("TETRAHEDRON", c.FIRST_TETRAHEDRON),
)  # fmt: skip


def check_cloths(rows: FileTables) -> None:
    """Check the tables of cloths.

    Raises
    ------
    ValueError
        If an index in them is out of range, or a number is invalid or inconsistent with others.
    """
    for name, of in (
        ("CLOTH_NUMBERS", "CLOTH"),
        ("FACE_NUMBERS", "FACE"),
        ("COUPLING_NUMBERS", "COUPLING"),
        ("CURVED_FACE_NUMBERS", "CURVED_FACE"),
        ("TETRAHEDRON_NUMBERS", "TETRAHEDRON"),
        ("PARTICLE_REST", "PARTICLE"),
        ("STARTED_PARTICLE", "PARTICLE"),
        ("PARTICLE_COUPLINGS", "PARTICLE"),
        ("PIN_NUMBERS", "PIN"),
    ):
        rows.count(name, len(rows[of]))
    cloths = rows["CLOTH"]
    rows.holds("CLOTH", c.PARTS, cloths[:, c.PARTS] >= 1)
    rows.within("CLOTH", c.DIMENSION, c.ROPE, c.VOLUME)
    generations = cloths[:, c.CLOTH_GENERATION]
    rows.holds("CLOTH", c.CLOTH_GENERATION, (generations >= 0) & (np.diff(generations, prepend=-1) > 0))
    for name, column in _RANGES:  # one cloth after the other
        least = 1 if name in ("PARTICLE", "FACE") else 0
        rows.holds("CLOTH", column, cloths[:, column + 1] >= cloths[:, column] + least)
        ends = np.concatenate(([0], cloths[:, column + 1]))
        rows.holds("CLOTH", column, cloths[:, column] == ends[:-1])
        rows.count(name, int(ends[-1]))
    _check_indices(rows, "FACE", c.CORNERS, 3, c.FIRST_FACE, c.FIRST_PARTICLE)
    _check_segments(rows)
    _check_indices(rows, "TETRAHEDRON", c.TETRAHEDRON_CORNERS, 4, c.FIRST_TETRAHEDRON, c.FIRST_PARTICLE)
    volumes = rows["TETRAHEDRON_NUMBERS"][:, c.REST_VOLUME]
    rows.holds("TETRAHEDRON_NUMBERS", c.REST_VOLUME, volumes > 0.0)
    counts = cloths[:, c.LAST_TETRAHEDRON] - cloths[:, c.FIRST_TETRAHEDRON]
    rows.holds("CLOTH", c.FIRST_TETRAHEDRON, (counts > 0) == (cloths[:, c.DIMENSION] == c.VOLUME))
    ratios = rows["CLOTH_NUMBERS"][:, c.POISSON_RATIO]
    rows.holds("CLOTH_NUMBERS", c.POISSON_RATIO, (ratios > -1.0) & (ratios < 0.5))
    _check_indices(rows, "CURVED_FACE", c.STENCIL, 6, c.FIRST_CURVED, c.FIRST_PARTICLE)
    _check_parents(rows)
    _check_indices(rows, "PIN", c.PINNED_PARTICLE, 1, c.FIRST_PIN, c.FIRST_PARTICLE)
    _check_couplings(rows)
    kinds = rows["BODY"][:, BODY_KIND]
    rows.within("PIN", c.PINNED_BODY, 0, len(kinds) - 1)
    rows.holds("PIN", c.PINNED_BODY, kinds[rows["PIN"][:, c.PINNED_BODY]] != REMOVED)
    _check_pairs(rows)
    rows.holds("PARTICLE", c.PARTICLE_MASS, rows["PARTICLE"][:, c.PARTICLE_MASS] > 0.0)
    rows.holds("PARTICLE", c.PARTICLE_INVERSE_MASS, rows["PARTICLE"][:, c.PARTICLE_INVERSE_MASS] >= 0.0)


def _check_indices(rows: FileTables, name: str, first: int, size: int, own: int, of: int) -> None:
    """Check that `size` columns of the rows of each cloth, its range `own`, are indices in its range `of`."""
    cloths, values = rows["CLOTH"], rows[name][:, first : first + size]
    cloth = np.repeat(np.arange(len(cloths)), cloths[:, own + 1] - cloths[:, own])
    least, most = cloths[cloth, of][:, None], cloths[cloth, of + 1][:, None]
    rows.holds(name, first, (values >= least) & (values < most))


def _check_segments(rows: FileTables) -> None:
    """Ask that the segments of ropes, and nothing else, have a length, and join consecutive vertices."""
    cloths, lengths = rows["CLOTH"], rows["FACE_NUMBERS"][:, c.REST_LENGTH]
    of = np.repeat(np.arange(len(cloths)), cloths[:, c.LAST_FACE] - cloths[:, c.FIRST_FACE])
    is_segment = cloths[of, c.DIMENSION] == c.ROPE
    rows.holds("FACE_NUMBERS", c.REST_LENGTH, np.where(is_segment, lengths > 0.0, lengths == 0.0))
    first = cloths[of, c.FIRST_PARTICLE] + np.arange(len(of)) - cloths[of, c.FIRST_FACE]
    ends = np.stack((first, first + 1, first + 1), axis=1)
    corners = rows["FACE"][:, c.CORNERS : c.CORNERS + 3]
    rows.holds("FACE", c.CORNERS, (corners == ends)[is_segment])
    ropes = cloths[cloths[:, c.DIMENSION] == c.ROPE]
    inner = ropes[:, c.LAST_PARTICLE] - ropes[:, c.FIRST_PARTICLE] - 1
    rows.holds("CLOTH", c.FIRST_FACE, ropes[:, c.LAST_FACE] - ropes[:, c.FIRST_FACE] == inner)


def _check_pairs(rows: FileTables) -> None:
    """Check the pairs of triangles that the next step continues with, if there are any."""
    known = len(rows["CLOTH_SEARCH"]) > 0
    rows.count("CLOTH_SEARCH", int(known))
    rows.count("PARTICLE_PATH", len(rows["PARTICLE"]) if known else 0)
    if not known:
        rows.count("CLOTH_PAIR", 0)
    rows.count("CLOTH_PAIR_NUMBERS", len(rows["CLOTH_PAIR"]))
    rows.within("CLOTH_PAIR", c.PAIR_PARTICLES, 0, len(rows["PARTICLE"]) - 1, 4)
    rows.within("CLOTH_PAIR", c.PAIR_FACES, 0, len(rows["FACE"]) - 1, 2)
    rows.within("CLOTH_PAIR", c.PAIR_KIND, VERTEX_FACE, CROSSING)


def _check_parents(rows: FileTables) -> None:
    """Check that vertices were split off vertices of the same cloth."""
    counts = np.diff(rows["CLOTH"][:, [c.FIRST_PARTICLE, c.LAST_PARTICLE]], axis=1)[:, 0]
    parents = rows["PARTICLE_REST"][:, c.SPLIT_FROM]
    rows.holds("PARTICLE_REST", c.SPLIT_FROM, (parents >= 0) & (parents < np.repeat(counts, counts)))


def _check_couplings(rows: FileTables) -> None:
    """Check that the couplings of particles are in the range of their cloth, and couple particles of the same cloth."""
    for own in rows["CLOTH"]:
        first, last = own[c.FIRST_PARTICLE], own[c.LAST_PARTICLE]
        ranges = rows["PARTICLE_COUPLINGS"][first:last, c.COUPLINGS : c.COUPLINGS + 2]
        offsets = rows["COUPLING"][own[c.FIRST_COUPLING] : own[c.LAST_COUPLING], c.OFFSET]
        coupled = np.flatnonzero(ranges[:, 0] != ranges[:, 1])
        kinds, of = np.unique(ranges[coupled], axis=0, return_inverse=True)
        begins, ends = np.append(kinds[:, 0], len(offsets)), np.append(0, kinds[:, 1])
        rows.holds("PARTICLE_COUPLINGS", c.COUPLINGS, (begins == ends) & (begins[:-1] < ends[1:]).all())
        rows.holds("PARTICLE_COUPLINGS", c.COUPLINGS, (ranges >= 0) & (ranges <= len(offsets)))
        if len(coupled):
            low, high = np.minimum.reduceat(offsets, begins[:-1])[of], np.maximum.reduceat(offsets, begins[:-1])[of]
            rows.holds("COUPLING", c.OFFSET, (low >= -coupled) & (high < last - first - coupled))
