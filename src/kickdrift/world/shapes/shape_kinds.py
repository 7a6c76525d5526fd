"""The catalogue of kinds of shapes, by number, and look-ups in their records."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from kickdrift.core.compilation import Function
from kickdrift.core.errors import ArgumentError
from kickdrift.world.shapes import box, capsule, cone, cylinder, heightfield, hull, mesh, plane, sphere, triangle
from kickdrift.world.shapes.record import SOLID, SURFACE, TRIANGLE_OF_SURFACE, Kind

_RECORDS = (
    plane.RECORD,
    triangle.RECORD,
    sphere.RECORD,
    capsule.RECORD,
    box.RECORD,
    hull.RECORD,
    mesh.RECORD,
    heightfield.RECORD,
    cylinder.RECORD,
    cone.RECORD,
)

KINDS: Mapping[int, Kind] = MappingProxyType({record.number: record for record in _RECORDS})
SHAPES: Mapping[str, type[Any]] = MappingProxyType(
    {record.name: record.shape for record in _RECORDS if record.shape is not None}
)
RAYS: Mapping[int, Function] = MappingProxyType(
    {record.number: record.ray for record in _RECORDS if record.ray is not None}
)
(_TRIANGLE,) = [record for record in _RECORDS if record.sort == TRIANGLE_OF_SURFACE]

if sorted(KINDS) != list(range(len(_RECORDS))) or len({record.name for record in _RECORDS}) != len(_RECORDS):
    raise ArgumentError(f"Kinds of shapes have the numbers {sorted(KINDS)}; number them from 0, with distinct names.")


def kind_of(shape: Any) -> Kind:
    """Return the record of a shape.

    Raises
    ------
    ArgumentError
        If it is not a shape.
    """
    kind = KINDS.get(getattr(shape, "kind", None))  # type: ignore[arg-type]
    if kind is None or type(shape) is not kind.shape:
        raise ArgumentError(f"shape={shape!r} is not a shape; give one, such as kickdrift.Box((1, 1, 1)).")
    return kind


def met_as(kind: int) -> int:
    """Return the kind with which rays and other shapes interact: TRIANGLE for surfaces, otherwise the kind itself."""
    return _TRIANGLE.number if KINDS[kind].sort == SURFACE else kind


def may_touch(one: int, other: int) -> bool:
    """Whether two kinds, as of `met_as`, can touch: one of them must be solid, so that its body can move."""
    sorts = (KINDS[one].sort, KINDS[other].sort)
    return SURFACE not in sorts and SOLID in sorts
