"""Handles: users' references to rows of a world, which detect that their row has been removed or reused."""

from typing import Any, ClassVar, Protocol, Self
from weakref import ReferenceType

from kickdrift.world.names import Names


class Registry(Protocol):
    """The rows of one kind in a world: its bodies, joints or cloths."""

    names: Names
    world: ReferenceType[Any] | None  # weak: handles do not keep the memory of a world that is gone

    def row(self, handle: Any) -> int:
        """Return the row of a handle; ArgumentError if it is gone."""
        ...

    def knows(self, index: int, generation: int) -> bool:
        """Whether a row is in use and has this generation."""
        ...


class Handle:
    """A row of a world, identified by its generation; equal handles refer to the same body, joint or cloth.

    A handle that is pickled, or copied by `copy.deepcopy`, takes its world along: it belongs to the copy.
    """

    __slots__ = ("_generation", "_index", "_last_name")
    _index: int
    _generation: int
    _last_name: str | None  # the last name seen
    registered_in: ClassVar[str]  # the attribute of a world that is the registry of its handles of this kind

    @property
    def index(self) -> int:
        """Its row in the arrays and tables of the world."""
        return self._index

    @property
    def generation(self) -> int:
        """How many of its kind were added before it; tells its handle from those of earlier occupants of its row."""
        return self._generation

    @property
    def _registry(self) -> Registry:
        raise NotImplementedError

    @property
    def name(self) -> str | None:
        """Its name, or None; unique in the world. Can be set.

        Once it has been removed or has broken, the last name that this handle knew.
        """
        if self._registry.knows(self.index, self._generation):
            self._last_name = self._registry.names.of(self.index)
        return self._last_name

    @name.setter
    def name(self, name: str | None) -> None:
        row, names = self._registry.row(self), self._registry.names
        names.give(row, names.checked(name, row))
        self._last_name = names.of(row)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._generation == other._generation and self._registry is other._registry

    def __hash__(self) -> int:
        return hash(self._generation)

    def __repr__(self) -> str:
        named = "" if self.name is None else f", name={self.name!r}"
        return f"{type(self).__name__}(index={self.index}, generation={self._generation}{named})"

    def __copy__(self) -> Self:
        return self

    def __reduce__(self) -> str | tuple[Any, ...]:
        world = None if self._registry.world is None else self._registry.world()
        if world is None:
            raise TypeError(
                f"{self!r} belongs to a world that no longer exists, without which it cannot be copied or pickled."
            )
        return _handle_in, (world, type(self), self.index, self._generation)


def _handle_in(world: Any, kind: Any, index: int, generation: int) -> Handle:
    """Return the handle of the same row in a copy of the world."""
    handle: Handle = kind(index, generation, getattr(world, kind.registered_in))
    return handle
