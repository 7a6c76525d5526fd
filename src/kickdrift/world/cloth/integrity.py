"""What has to hold of the tables of cloths that come from a file: compiled code trusts every index in them."""

from typing import TYPE_CHECKING

import numpy as np

from kickdrift.world.cloth import layout as c
from kickdrift.world.integration import BODY_KIND, REMOVED

if TYPE_CHECKING:
    from kickdrift.world.integrity import Rows

_RANGES = (("PARTICLE", c.FIRST_PARTICLE), ("FACE", c.FIRST_FACE), ("FOLD", c.FIRST_FOLD))


def check_cloths(rows: "Rows") -> None:
    """Check them.

    Raises
    ------
    ValueError
        If a number in them could lead a step astray.
    """
    for name, of in (
        ("CLOTH_NUMBERS", "CLOTH"),
        ("FACE_NUMBERS", "FACE"),
        ("FOLD_NUMBERS", "FOLD"),
        ("PIN_NUMBERS", "PIN"),
    ):
        rows.count(name, len(rows[of]))
    rows.count("PARTICLE_REST", len(rows["PARTICLE"]))
    cloths = rows["CLOTH"]
    rows.holds("CLOTH", c.PARTS, cloths[:, c.PARTS] >= 1)
    for name, column in _RANGES:  # one cloth after the other, none of them empty
        rows.holds("CLOTH", column, cloths[:, column + 1] > cloths[:, column])
        ends = np.concatenate(([0], cloths[:, column + 1]))
        rows.holds("CLOTH", column, cloths[:, column] == ends[:-1])
        rows.count(name, int(ends[-1]))
    _check_indices(rows, "FACE", c.CORNERS, 3, c.FIRST_FACE, c.FIRST_PARTICLE)
    _check_indices(rows, "FACE", c.SIDES, 3, c.FIRST_FACE, c.FIRST_FOLD)
    _check_indices(rows, "FOLD", c.EDGE, 4, c.FIRST_FOLD, c.FIRST_PARTICLE)
    _check_indices(rows, "FOLD", c.FOLDED_FACES, 2, c.FIRST_FOLD, c.FIRST_FACE)
    kinds = rows["BODY"][:, BODY_KIND]
    rows.within("PIN", c.PINNED_PARTICLE, 0, max(len(rows["PARTICLE"]) - 1, 0))
    rows.within("PIN", c.PINNED_BODY, 0, len(kinds) - 1)
    rows.holds("PIN", c.PINNED_BODY, kinds[rows["PIN"][:, c.PINNED_BODY]] != REMOVED)
    rows.holds("PARTICLE", c.PARTICLE_MASS, rows["PARTICLE"][:, c.PARTICLE_MASS] > 0.0)
    rows.holds("PARTICLE", c.PARTICLE_INVERSE_MASS, rows["PARTICLE"][:, c.PARTICLE_INVERSE_MASS] >= 0.0)


def _check_indices(rows: "Rows", name: str, first: int, size: int, own: int, of: int) -> None:
    """Ask that columns of a table, of which each cloth has those from `own` on, are rows of the same cloth from `of` on."""
    cloths, values = rows["CLOTH"], rows[name][:, first : first + size]
    cloth = np.repeat(np.arange(len(cloths)), cloths[:, own + 1] - cloths[:, own])
    least, most = cloths[cloth, of][:, None], cloths[cloth, of + 1][:, None]
    rows.holds(name, first, (values >= least) & (values < most))
