"""The columns of a recording that belong to each cloth."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.deformables.registry import Cloths
from kickdrift.world.deformables.row_ranges import rows_of
from kickdrift.world.recordings.appearance import DrawnCloth, drawn_cloths
from kickdrift.world.tables import CLOTH, PARTICLE, PARTICLE_REST

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
_NONE = -1


class RecordedCloths:
    """The columns of cloths that are added, removed and cut: those of a cloth are consecutive.

    Attributes
    ----------
    drawn : list of DrawnCloth
        In the order in which they were added, including removed ones.
    """

    def __init__(self, cloths: Cloths) -> None:
        self._cloths = cloths
        self._drawn: dict[int, DrawnCloth] = {}  # by generation

    @property
    def size(self) -> int:
        """The number of columns."""
        return self.drawn[-1].last if self._drawn else 0

    @property
    def drawn(self) -> list[DrawnCloth]:
        """The cloths, with their present or last known names."""
        names = self._cloths.names
        for row, generation in enumerate(self._generations()):
            if generation in self._drawn:
                self._drawn[generation] = self._drawn[generation]._replace(name=names.of(row))
        return list(self._drawn.values())

    @property
    def changed(self) -> bool:
        """Whether a cloth was added, or has more vertices, since `take_over`."""
        counts = np.diff(self._cloths.tables.array(CLOTH)[:, [c.FIRST_PARTICLE, c.LAST_PARTICLE]])[:, 0].tolist()
        known = [self._drawn.get(generation) for generation in self._generations()]
        return any(cloth is None or cloth.last - cloth.first != n for cloth, n in zip(known, counts, strict=True))

    def take_over(self) -> Integers:
        """Assign columns to the present cloths, and return the columns from which they take over; -1 for new ones.

        Vertices that were split off were where their originals were.
        """
        before, looks = dict(self._drawn), drawn_cloths(self._cloths)
        now = {**before, **dict(zip(self._generations(), looks, strict=True))}
        rows = {generation: row for row, generation in enumerate(self._generations())}
        sources, end = [], 0
        for generation, cloth in now.items():
            begin, count = end, cloth.last - cloth.first
            end += count
            self._drawn[generation] = cloth._replace(first=begin, last=end)
            sources.append(self._source(before.get(generation), rows.get(generation), count))
        return np.concatenate([np.zeros(0, dtype=np.int64), *sources])

    def put(self, columns: Floats) -> None:
        """Write the positions of the vertices of all cloths, NaN of those that have been removed."""
        columns[:] = np.nan
        for row, generation in enumerate(self._generations()):
            cloth = self._drawn[generation]
            columns[cloth.first : cloth.last] = rows_of(self._cloths.tables, row, c.FIRST_PARTICLE, PARTICLE)[:, :3]

    def _generations(self) -> list[int]:
        return [int(number) for number in self._cloths.tables.array(CLOTH)[:, c.CLOTH_GENERATION]]

    def _source(self, before: DrawnCloth | None, row: int | None, count: int) -> Integers:
        """Return the former columns of the vertices of a cloth, or of the vertices from which they were split."""
        if before is None:
            return np.full(count, _NONE)
        known = before.last - before.first
        found = np.arange(before.first, before.first + count)
        if row is not None:
            parents = rows_of(self._cloths.tables, row, c.FIRST_PARTICLE, PARTICLE_REST)[known:, c.SPLIT_FROM]
            for vertex, parent in enumerate(parents.astype(np.int64).tolist(), start=known):
                found[vertex] = found[parent]
        return found
