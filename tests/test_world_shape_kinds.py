"""Kinds of shapes: what their records demand, and what becomes of shapes that have none."""

from dataclasses import replace
from itertools import combinations_with_replacement

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import ArgumentError
from kickdrift.world.bodies.part import Part
from kickdrift.world.collision.narrow_phase.pair_dispatch import PAIRS
from kickdrift.world.shapes import sphere
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.record import SOLID, Kind
from kickdrift.world.shapes.shape_kinds import KINDS, kind_of, met_as
from kickdrift.world.shapes.sphere import Sphere
from kickdrift.world.tables import COLLIDERS


class Torus:
    """What knows all that shapes do, but has no record."""

    kind, reach, numbers = 99, 1.0, np.ones(2)
    mass_properties = Sphere.mass_properties


class LooksLikeASphere(Torus):
    kind = Sphere.kind


@pytest.mark.parametrize(
    "shape",
    [
        Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]),
        HeightField(np.zeros((2, 2)), 1.0),
        Hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]),
    ],
)
def test_numbers_of_shapes_of_many_triangles_are_computed_once(shape):
    assert shape.numbers is shape.numbers


@pytest.mark.parametrize("shape", [Torus(), LooksLikeASphere(), "sphere", None])
def test_a_shape_of_no_kind_is_refused_and_leaves_nothing_behind(shape):
    world = kd.World()
    with pytest.raises(ArgumentError, match="shape"):
        world.add_body(shape)
    with pytest.raises(ArgumentError, match="is not a shape"):
        Part(shape)
    with pytest.raises(ArgumentError, match="is not a shape"):
        kind_of(shape)
    assert len(world.position) == 1


@pytest.mark.parametrize("missing", ["shape", "extent", "ray"])
def test_a_record_without_what_its_kind_needs_is_refused(missing):
    with pytest.raises(ArgumentError, match=f"'sphere' must have {missing}="):
        replace(sphere.RECORD, **{missing: None})


@pytest.mark.parametrize("missing", ["numbers", "reach", "mass_properties"])
def test_a_record_of_a_shape_that_lacks_something_is_refused(missing):
    names = {name: None for name in ("numbers", "reach", "mass_properties") if name != missing}
    shape = type("Half", (), {"kind": Sphere.kind, **names})
    with pytest.raises(ArgumentError, match=f"has no {missing}"):
        replace(sphere.RECORD, shape=shape)


def test_a_record_and_its_shape_have_the_same_number():
    with pytest.raises(ArgumentError, match="is number 98, but its shape has 2"):
        Kind(number=98, name="ball", sort=SOLID, shape=Sphere, extent=sphere.RECORD.extent, ray=sphere.RECORD.ray)


def test_all_pairs_that_can_touch_have_a_function_and_a_place_for_its_address():
    moving = [kind.number for kind in KINDS.values() if kind.sort == SOLID]
    for pair in combinations_with_replacement(sorted(map(met_as, KINDS)), 2):
        assert (pair in PAIRS) == bool(set(pair) & set(moving))
    assert max(KINDS) < COLLIDERS.width
