"""Members in a Zarr group on disk: the process that computes a chunk writes it, whole and once."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.errors import ArgumentError, FileFormatError, missing_extra
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.description import Description, unit_attributes
from kickdrift.engine.zarr_group import Array, ZarrGroup
from kickdrift.scale.moments import read, spelled
from kickdrift.scale.prepared import Prepared
from kickdrift.scale.results import Results
from kickdrift.scale.stored_array import StoredArray

_CHUNK = 1 << 24  # bytes of an array, at most, where a member has not more
_TEXT = f"<U{max(len(outcome.name) for outcome in Outcome)}"
_OF_MEMBERS = {
    "step": ("step", "float64", ()),
    "step_range": ("step_range", "float64", (2,)),
    "n_steps": ("n_steps", "int64", ()),
    "n_rejected": ("rejected", "int64", ()),
    "n_force_evaluations": ("evaluations", "int64", ()),
}
"""What is kept of members beside their rows: the field of the results, the type, and the shape of each."""


class MemberStore(ZarrGroup):
    """A group of arrays along members and time, created at full size, with NaN for members that are not done.

    A chunk of members is done when its ``status`` exists, which is written last. The parts that a worker wrote before it died
    are not written again: the bits are the same.

    Attributes
    ----------
    members_of_chunk : int
        Known once the group is created or opened.
    """

    members_of_chunk = 0

    def __reduce__(self) -> tuple[Any, ...]:
        return MemberStore, (self.path.absolute(), self._run)

    def begin(self, prepared: Prepared, about: Description, size: int, results: Results) -> None:
        """Create the group, for chunks of a number of members; or open it, and take over the outcomes of finished members.

        Raises
        ------
        ArgumentError
            If the path is invalid, or holds something else.
        FileFormatError
            If it cannot be written.
        """
        there = self.check(again=True)
        if there:
            try:
                self.open()
            except FileFormatError:  # its process was killed while creating it
                there = False
        if there:
            self._take_over(prepared, results)
        else:
            self._create(prepared, about, size)

    def open(self) -> None:
        """Open the group, to write to it.

        Raises
        ------
        FileFormatError
            If it is not there, as on a machine that does not share the folder.
        """
        with self._writing():
            try:
                self._group = self._zarr.open_group(self.path, mode="r+", use_consolidated=True)
                self.members_of_chunk = self._group["status"].chunks[0]
            except (OSError, LookupError, ValueError) as error:
                raise FileFormatError(
                    f"save_to={str(self.path)!r} cannot be opened ({type(error).__name__}: {error}); all workers must"
                    " share its folder."
                ) from None

    def array(self, name: str) -> Any:
        """Return an array of all members that is read from disk on access."""
        return StoredArray(self._group[_key(name)])

    def put(self, first: int, prepared: Prepared, results: Results) -> Results:
        """Write the members of a chunk from the `first` on; return their outcomes, without rows.

        Raises
        ------
        FileFormatError
            If they cannot be written.
        """
        rows = {"x": results.x, "v": results.v} | {
            _key(name): prepared.evaluate(name, results.x, results.v) for name in prepared.system.quantities
        }
        if results.v.shape != results.x.shape:
            del rows["v"]
        known = {name: getattr(results, field) for name, (field, *_) in _OF_MEMBERS.items()}
        known["last"] = np.array([spelled(own) for own in results.last], dtype=object)
        known["message"] = np.array(results.messages, dtype=object)
        if prepared.events:
            known["events"] = np.array([spelled(own) for own in results.zeros], dtype=object)
        known["status"] = np.array([status.name for status in results.status], dtype=_TEXT)
        with self._writing():
            for name, values in {**rows, **known}.items():
                self._write(self._group[name], first, values)
        return replace(results, x=results.x[:, :0], v=results.v[:, :0])

    def _write(self, array: Any, first: int, values: NDArray[Any]) -> None:
        """Write those chunks of an array that are not there yet."""
        last, along = first + len(values), array.chunks[1] if values.ndim > 1 else 1
        for k in range(-(-values.shape[1] // along) if values.ndim > 1 else 1):
            place = (first // array.chunks[0], *(k,)[: values.ndim - 1], *(0,) * (values.ndim - 2))
            if (self.path / array.path / array.metadata.encode_chunk_key(place)).exists():
                continue
            if values.ndim == 1:
                array[first:last] = values
            else:
                array[first:last, k * along : (k + 1) * along] = values[:, k * along : (k + 1) * along]

    def _create(self, prepared: Prepared, about: Description, size: int) -> None:
        self.members_of_chunk = size
        members, times, system, units = prepared.members, prepared.t.size, prepared.system, about.units
        arrays = {"x": Array(about.dimensions, system.x0.shape, units.get("x", ""))}
        if system.v0.shape == system.x0.shape:  # first-order equations have no v
            arrays["v"] = Array(about.dimensions, system.v0.shape, units.get("v", ""))
        for name, quantity in system.quantities.items():
            key, vector = _key(name), quantity.size > 1
            arrays[key] = Array((f"{key}_component",) * vector, (quantity.size,) * vector, quantity.unit)
        taken = {*arrays, *_OF_MEMBERS, *about.coordinates, "events", "last", "message", "parameter", "range"} - {
            "step"
        }
        if known := sorted(taken & members.parameters.keys()):
            raise ArgumentError(
                f"args has the name {known[0]!r}, which save_to={str(self.path)!r} uses for something else; give"
                " another."
            )
        events = ["events"] if prepared.events else []
        coordinates = [*members.parameters, *_OF_MEMBERS, *events, "last", "message", "status"]
        words = {"system": about.system, "method": about.method, "source": about.source}
        with self._writing():
            self._begin({**words, "coordinates": " ".join(dict.fromkeys(coordinates))}, about.coordinates)
            self._label("time", prepared.t, ("time",), units.get("t", ""))
            for name, values in members.parameters.items():
                if name != "step":
                    self._label(name, np.asarray(values), ("member", "parameter")[: np.ndim(values)], "")
            for name, array in arrays.items():
                most = max(1, _CHUNK // (8 * size * int(np.prod(array.shape, initial=1))))
                parts = -(-times // most)  # as long as each other, as Zarr fills up the last one
                self._add(
                    name,
                    "float64",
                    (members.count, times, *array.shape),
                    (size, -(-times // parts), *array.shape),
                    ("member", "time", *array.dimensions),
                    unit_attributes(array.unit),
                    np.nan,
                )
            for name, (_, kind, shape) in _OF_MEMBERS.items():
                self._add(name, kind, (members.count, *shape), (size, *shape), ("member", "range")[: 1 + len(shape)])
            if prepared.events:
                self._add("events", str, (members.count,), (size,), ("member",))
            self._add("last", str, (members.count,), (size,), ("member",))
            self._add("message", str, (members.count,), (size,), ("member",))
            self._add("status", _TEXT, (members.count,), (size,), ("member",))
            self._commit()

    def _label(self, name: str, values: NDArray[Any], dimensions: tuple[str, ...], unit: str) -> None:
        self._add(name, values.dtype, values.shape, values.shape, dimensions, unit_attributes(unit))[:] = values

    def _add(
        self,
        name: str,
        kind: Any,
        shape: tuple[int, ...],
        chunks: tuple[int, ...],
        dimensions: tuple[str, ...],
        attributes: Mapping[str, Any] | None = None,
        fill: Any = None,
    ) -> Any:
        return self._create_array(
            name,
            shape=shape,
            chunks=chunks,
            dtype=kind,
            dimension_names=dimensions,
            attributes=dict(attributes or {}),
            fill_value=fill,
        )

    def _take_over(self, prepared: Prepared, results: Results) -> None:
        with self._writing():
            status, messages, last = (self._group[name][:] for name in ("status", "message", "last"))
            events = self._group["events"][:] if prepared.events else ()
            done = np.flatnonzero(status != "")
            for name, (field, *_) in _OF_MEMBERS.items():
                getattr(results, field)[done] = self._group[name][:][done]
            for i in done:
                results.status[i], results.messages[i] = Outcome[str(status[i])], str(messages[i])
                results.last[i] = read(str(last[i]), results.x.shape[2:], results.v.shape[2:])
                if prepared.events:
                    results.zeros[i] = read(str(events[i]), results.x.shape[2:], results.v.shape[2:])
        results.done[done] = True


def arrays_of(path: Path) -> Callable[[str], Any]:
    """Return a function that reads the arrays of a group by their names.

    Raises
    ------
    MissingExtraError
        If zarr is not installed.
    """
    try:
        import zarr
    except ImportError:
        raise missing_extra("kickdrift.load of a folder", "zarr", "zarr") from None
    group: Any = zarr.open_group(path, mode="r", use_consolidated=True)
    return lambda name: StoredArray(group[_key(name)])


def _key(name: str) -> str:
    return name.replace(" ", "_")
