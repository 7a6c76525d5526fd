"""What a world leaves behind: snapshots and files that it goes on from with the same bits, and recordings."""

import copy
import json
import math
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kickdrift as kd
from kickdrift.core import archive
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.engine.progress import Bar
from kickdrift.io.shapes import Catalogue, shapes_of
from kickdrift.io.world_file import MADE
from kickdrift.scenes.worlds import newtons_cradle, pyramid
from kickdrift.world import settings as settings_
from kickdrift.world.bodies.part import Part
from kickdrift.world.contacts import layout as c
from kickdrift.world.deformables.layout import PAIR_FACES, PAIR_KIND, PAIR_PARTICLES
from kickdrift.world.joints import layout as j
from kickdrift.world.layout import BODY_KIND, BODY_ROW, DYNAMIC, SHAPE_KIND
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.sphere import Sphere
from kickdrift.world.snapshot import TABLES
from kickdrift.world.step import stepping
from kickdrift.world.step.status import STATUS
from kickdrift.world.tables import CONTACT, GEOMETRY, SHAPE

STEP = 1 / 60


def balls():
    """Balls of two sizes that fall onto each other, one of them spinning."""
    world = kd.World()
    world.add_plane(restitution=0.5)
    for k in range(6):
        world.add_sphere(
            radius=0.1 + 0.05 * (k % 2), position=(0.02 * k, 0.01 * k**2, 0.3 + 0.35 * k), restitution=0.5,
            angular_velocity=(0.0, 3.0 * k, 1.0),
        )  # fmt: skip
    return world


def tower():
    return pyramid(base=4)


def cradle():
    return newtons_cradle(count=3).world


def state(world):
    """All tables as bytes.

    But for the events of the last call of `advance`.
    """
    tables = {name: world.tables.array(table).copy() for name, table in TABLES.items() if name != "EVENTS"}
    return {"time": world.time, "n_steps": world.n_steps, **{name: rows.tobytes() for name, rows in tables.items()}}


@pytest.fixture(scope="module")
def rolled():
    """A recording of some balls, and the world after it."""
    world = balls()
    return world.run(0.5, STEP), world


# Snapshots


@pytest.mark.parametrize("make", [balls, tower, cradle])
def test_a_world_goes_on_with_the_same_bits_after_restore(make):
    world = make()
    world.advance(STEP, 50)
    then = world.snapshot()
    before = state(world)
    world.advance(STEP, 50)
    after = state(world)
    assert after["POSE"] != before["POSE"]
    for _ in range(2):
        world.restore(then)
        assert state(world) == before
        world.advance(STEP, 50)
        assert state(world) == after


def pushed(t, force):
    """A force whose values depend on the last bit of the time."""
    for k in range(len(force)):
        force[k, 0] = math.sin(1e15 * t)


@pytest.mark.parametrize("go_on", ["", "restored", "from a file"])
def test_the_times_of_equal_steps_do_not_depend_on_how_they_are_called(go_on, tmp_path):
    def world():
        one = kd.World()
        one.add_sphere(radius=0.1, mass=1.0)
        one.add_force(pushed)
        return one

    together, alone = world(), world()
    together.advance(STEP, 50)
    for k in range(50):
        if k == 20 and go_on == "restored":
            snapshot, alone = alone.snapshot(), world()
            alone.restore(snapshot)
        elif k == 20 and go_on:
            alone.save(tmp_path / "world.kd")
            alone = kd.load_world(tmp_path / "world.kd", [pushed])
        alone.step(STEP)
    assert alone.time == together.time == 50 * STEP
    assert alone.n_steps == together.n_steps
    assert np.array_equal(alone.velocity, together.velocity)


def test_the_count_of_equal_steps_begins_anew_with_another_step_or_time():
    world = kd.World()
    world.add_sphere(radius=0.1, mass=1.0)
    world.advance(0.1, 3)
    world.step(0.3)
    assert world.time == 0.1 * 3 + 0.3
    world.time = 7.0
    world.advance(0.3, 2)
    assert world.time == 7.0 + 2 * 0.3


def test_a_snapshot_does_not_change_with_its_world():
    world = balls()
    then = world.snapshot()
    kept = then.tables["POSE"].copy()
    world.advance(STEP, 3)
    world.position[1] = 7.0
    world.add_sphere(radius=1.0, position=(0, 0, 9))
    assert np.array_equal(then.tables["POSE"], kept)
    with pytest.raises(ValueError, match="read-only"):
        then.tables["POSE"][0, 0] = 1.0
    with pytest.raises(TypeError):
        then.tables["POSE"] = kept
    with pytest.raises(AttributeError):
        then.time = 1.0


def test_restore_undoes_bodies_added_and_removed():
    world = balls()
    first = world.bodies.handle(2)
    world.advance(STEP, 20)
    then, before = world.snapshot(), state(world)
    world.remove(first)
    added = [world.add_box((0.1, 0.2, 0.3), position=(k, 0, 3)) for k in range(3)]
    world.advance(STEP, 20)
    world.restore(then)
    assert state(world) == before
    world.apply_force(first, (0, 0, 1))  # it is there again
    for body in added:
        with pytest.raises(ArgumentError, match=r"removed|not in this world"):
            world.apply_force(body, (0, 0, 1))


def test_handles_of_bodies_after_a_snapshot_are_never_those_of_others():
    world = balls()
    then = world.snapshot()
    lost = world.add_sphere(radius=0.1)
    world.restore(then)
    found = world.add_sphere(radius=0.1)
    assert found.index == lost.index
    assert found != lost
    with pytest.raises(ArgumentError, match="removed"):
        world.apply_force(lost, (0, 0, 1))
    world.apply_force(found, (0, 0, 1))
    world.remove(found)
    then = world.snapshot()
    lost = world.add_sphere(radius=0.1)
    world.restore(then)
    assert world.add_sphere(radius=0.1) != lost


def test_handles_of_joints_after_a_snapshot_are_never_those_of_others():
    world = cradle()
    then = world.snapshot()
    bodies = [world.bodies.handle(row) for row in (1, 3)]
    lost = world.add_distance_joint(*bodies, anchor_a=(0, 0, 0), anchor_b=(1, 0, 0))
    world.restore(then)
    with pytest.raises(ArgumentError):
        _ = lost.position
    found = world.add_distance_joint(*bodies, anchor_a=(0, 0, 0), anchor_b=(1, 0, 0))
    assert found.index == lost.index
    with pytest.raises(ArgumentError):
        _ = lost.position
    assert abs(found.position) < 1e-12


def test_another_world_continues_from_a_snapshot():
    world = balls()
    world.advance(STEP, 30)
    other = kd.World(gravity=(0, 0, 0), substeps=7, sleeping=True, plane_normal=(0, 1, 0))
    other.add_box((1, 1, 1))
    other.advance(STEP, 2)
    other.restore(world.snapshot())
    for each in (world, other):
        each.advance(STEP, 30)
    assert state(other) == state(world)


def test_rows_are_used_again_in_the_same_order_after_restore():
    world = balls()
    for row in (2, 4, 3):
        world.remove(world.bodies.handle(row))
    then = world.snapshot()
    rows = [world.add_sphere(radius=0.2).index for _ in range(4)]
    world.restore(then)
    assert [world.add_sphere(radius=0.2).index for _ in range(4)] == rows == [3, 4, 2, 8]


# Files


def test_worlds_go_on_with_the_same_bits_in_another_process(tmp_path):
    worlds = {make.__name__: make() for make in (balls, tower, cradle)}
    for name, world in worlds.items():
        world.advance(STEP, 50)
        assert world.save(tmp_path / name) == tmp_path / f"{name}.npz"
    code = (
        "import kickdrift as kd\n"
        "from kickdrift.world.tables import MANIFOLD, POSE\n"
        f"for name in {list(worlds)!r}:\n"
        f"    world = kd.load_world(f'{tmp_path}/{{name}}.npz')\n"
        f"    world.advance({STEP!r}, 50)\n"
        "    print(world.time.hex(), world.tables.array(POSE).tobytes().hex(),"
        " world.tables.array(MANIFOLD).tobytes().hex())"
    )
    others = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    for world, other in zip(worlds.values(), others, strict=True):
        world.advance(STEP, 50)
        after = state(world)
        assert other.split() == [world.time.hex(), after["POSE"].hex(), after["MANIFOLD"].hex()]


def everything():
    """A world with every kind of shape, a compound, surfaces of all sorts, a removed body and an unused shape."""
    world = kd.World(gravity=(0.1, 0.2, -3.0), substeps=3)
    world.add_plane(normal=(0.1, 0, 1), friction=0.3)
    world.add_height_field([[0.0, 0.1, 0.0], [0.1, 0.0, 0.2]], 2.0, position=(-9, 0, 0))
    world.add_mesh([[0, 0, 0], [5, 0, 0], [0, 5, 0]], [[0, 1, 2]], position=(20, 0, 0))
    world.remove(world.add_capsule(0.1, 0.7, position=(0, 5, 5)))
    world.add_sphere(radius=0.3, position=(0, 0, 2), layer=3, collides_with=[0, 3], rolling_resistance=0.01)
    world.add_capsule(0.2, 0.5, position=(2, 0, 2), surface_velocity=np.array([0.1, 0.0, 0.0]), mass=2)
    world.add_hull(np.random.default_rng(1).normal(size=(9, 3)) * 0.4, position=(4, 0, 2), sensor=True)
    world.add_cylinder(0.2, 0.5, position=(6, 0, 2))
    world.add_cone(0.2, 0.5, position=(8, 0, 2))
    parts = [Part(Box((0.2, 0.3, 0.4))), Part(Sphere(0.1), position=(0, 0, 0.3), density=5000.0)]
    world.add_body(parts, position=(0, 0, 4), damping=0.1)
    world.add_box((1, 1, 1), position=(-3, 0, 4), kinematic=True, velocity=(0, 0, -0.1))
    return world


def test_what_is_saved_is_loaded(tmp_path):
    world = everything()
    loaded = kd.load_world(world.save(tmp_path / "world.npz"))
    places = ("GEOMETRY", "SHAPE")  # numbers of shapes that were removed are not written, so that others lie elsewhere
    ours, theirs = ({k: v for k, v in state(each).items() if k not in places} for each in (world, loaded))
    assert ours == theirs
    kinds, again = (each.tables.array(SHAPE)[:, [SHAPE_KIND, BODY_ROW]] for each in (world, loaded))
    assert np.array_equal(kinds, again)
    assert set(loaded.shape_rows.begins) < set(world.shape_rows.begins)
    assert (loaded.bodies.free, loaded.shape_rows.free) == (world.bodies.free, world.shape_rows.free)
    for row, (shape, position, orientation, surface) in world.shape_rows.shapes.items():
        again = loaded.shape_rows.shapes[row]
        assert type(again.shape) is type(shape)
        assert np.array_equal(again.shape.numbers, shape.numbers)
        assert np.array_equal(again.position, position)
        assert np.array_equal(again.orientation, orientation)
        assert again.surface.friction == surface.friction
    for each in (world, loaded):
        each.add_sphere(radius=0.3, position=(0, 0, 8))
        each.advance(STEP, 30)
    assert np.array_equal(loaded.position, world.position, equal_nan=True)


def test_the_numbers_of_hulls_that_were_removed_do_not_stay():
    world, rng = kd.World(), np.random.default_rng(0)
    world.add_plane()
    stays = [world.add_hull(rng.normal(size=(20, 3)), position=(0, 0, 5 + 4 * k)) for k in range(2)]
    untouched = copy.deepcopy(world)
    sizes = []
    for _ in range(300):
        world.remove(world.add_hull(rng.normal(size=(20, 3)), position=(9, 0, 5)))
        sizes.append(world.tables.count(GEOMETRY))
    assert max(sizes[150:]) <= max(sizes[:150])
    untouched.advance(STEP, 90)
    world.advance(STEP, 90)
    assert [np.array_equal(untouched.position[k], world.position[k]) for k in range(1, 4)] == [True] * 3
    assert len(stays) == 2


def test_forces_are_given_again_and_the_bits_are_the_same(tmp_path):
    def wind(t, velocity, force):
        for body in range(len(force)):
            force[body, 0] += 0.1 * (1.0 + t - velocity[body, 0])

    world = balls()
    world.add_force(wind)
    world.advance(STEP, 10)
    path = world.save(tmp_path / "world.npz")
    with pytest.raises(ArgumentError, match=r"forces has 0 functions, but the world in .* had 1"):
        kd.load_world(path)
    with pytest.raises(ArgumentError, match="forces has 2 functions"):
        kd.load_world(path, forces=[wind, wind])
    loaded = kd.load_world(path, forces=[wind])
    for each in (world, loaded):
        each.advance(STEP, 10)
    assert state(loaded) == state(world)


@pytest.mark.parametrize("steps", [20, 60])
def test_a_heap_that_is_solved_directly_goes_on_with_the_same_bits_from_a_file(steps, tmp_path):
    angles, rng = np.arange(24) * 2 * np.pi / 24, np.random.default_rng(0)
    prism = [(0.1 * np.cos(a), 0.1 * np.sin(a), z) for a in angles for z in (-0.04, 0.04)]
    world = kd.World()
    world.add_box((4, 4, 1), position=(0, 0, -0.5), static=True, friction=0.5)
    for k in range(30):
        world.add_hull(prism, position=(*rng.normal(size=2) * 0.1, 0.1 + 0.12 * k), friction=0.5)
    world.advance(1 / 60, steps)
    loaded = kd.load_world(world.save(tmp_path / "world.npz"))
    for each in (world, loaded):
        each.advance(1 / 60, 30)
    assert np.array_equal(loaded.position, world.position)


def test_a_world_of_numpy_numbers_is_saved(tmp_path):
    world = kd.World(sleeping=np.bool_(True), substeps=np.int64(3))
    rod = world.add_capsule(0.05, 0.5, position=(0, 0, 3), restitution=np.float32(0.5), layer=np.int8(3))
    hinge = world.add_hinge(None, rod, anchor=rod.position, axis=(0, 1, 0), name="hinge")
    world.advance(np.float32(STEP), np.int64(3))
    hinge.set_drive(kd.Drive(np.float64(10), np.float32(1)))
    loaded = kd.load_world(world.save(tmp_path / "world.npz"))
    world.advance(STEP, 20)
    loaded.advance(STEP, 20)
    assert state(loaded) == state(world)


def _rewritten(path, change):
    """Change what a file holds, and give it a digest that fits."""
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(str(arrays.pop("header")))
    header.pop("digest")
    change(header, arrays)
    archive.write(path, header, arrays)


def _tampered(path, change):
    """Change what a file holds, and leave the digest as it was."""
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(str(arrays.pop("header")))
    change(header, arrays)
    np.savez(path, header=np.array(json.dumps(header)), **arrays)


def _drop(which, name):
    return lambda header, arrays: (header, arrays)[which].pop(name)


def _put(which, name, value):
    return lambda header, arrays: (header, arrays)[which].update({name: value})


DAMAGE = {
    "empty": lambda path: path.write_bytes(b""),
    "text": lambda path: path.write_text("a world"),
    "pickle": lambda path: path.write_bytes(pickle.dumps({"POSE": [1]})),
    "zip": lambda path: zipfile.ZipFile(path, "w").close(),
    "objects": lambda path: np.savez(path, header=np.array([{}], dtype=object)),
    "arrays": lambda path: np.savez(path, a=np.zeros(3)),
    "half": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "cut": lambda path: path.write_bytes(path.read_bytes()[:-1]),
    "no JSON": lambda path: np.savez(path, header=np.array("{")),
    "a list": lambda path: np.savez(path, header=np.array("[]")),
    "foreign": lambda path: _rewritten(path, _put(0, "format", "something else")),
    "no format": lambda path: _rewritten(path, _drop(0, "format")),
    "no digest": lambda path: _tampered(path, _drop(0, "digest")),
    "time changed": lambda path: _tampered(path, _put(0, "time", 3.0)),
    "no count of steps": lambda path: _rewritten(path, _put(0, "counted", [0.0, math.nan, 1])),
    "pose changed": lambda path: _tampered(path, lambda h, a: a["table POSE"].__setitem__((1, 0), 3.0)),
    "row dropped": lambda path: _tampered(path, lambda h, a: a.update({"table BODY": a["table BODY"][1:]})),
    "table dropped": lambda path: _rewritten(path, _drop(1, "table CONTACT")),
    "table too much": lambda path: _rewritten(path, _put(1, "table MORE", np.zeros((1, 8)))),
    "table too narrow": lambda path: _rewritten(path, _put(1, "table POSE", np.zeros((7, 7)))),
    "table of floats": lambda path: _rewritten(path, lambda h, a: a.update({"table BODY": a["table BODY"] * 1.0})),
    "unknown shape": lambda path: _rewritten(path, lambda h, a: h["shapes"][1].update(kind="torus")),
    "negative radius": lambda path: _rewritten(path, lambda h, a: a["shape numbers"].__imul__(-1.0)),
    "shape without numbers": lambda path: _rewritten(path, _put(1, "shape numbers", np.zeros(0))),
    "numbers without shape": lambda path: _rewritten(path, _put(1, "shape numbers", np.ones(9))),
    "unknown surface": lambda path: _rewritten(path, lambda h, a: h["surfaces"][0].update(colour="red")),
    "surface of friction -1": lambda path: _rewritten(path, lambda h, a: h["surfaces"][0].update(friction=-1.0)),
    "free rows of words": lambda path: _rewritten(path, _put(0, "free_bodies", 3)),
    "time of words": lambda path: _rewritten(path, _put(0, "time", "noon")),
    "time without end": lambda path: _rewritten(path, _put(0, "time", float("inf"))),
    "name of no body": lambda path: _rewritten(path, _put(0, "body_names", [[99, "ghost"]])),
    "two of a name": lambda path: _rewritten(path, _put(0, "body_names", [[1, "twin"], [2, "twin"]])),
    "bodies made": lambda path: _rewritten(path, _put(0, "n_bodies_made", 3)),
    "free rows that are taken": lambda path: _rewritten(path, _put(0, "free_bodies", [2])),
    "ground that moves": lambda path: _rewritten(path, _cell("BODY", 0, BODY_KIND, DYNAMIC)),
    "mesh that moves": lambda path: _rewritten(path, _cell("BODY", 1, BODY_KIND, DYNAMIC)),
    "static body of a mass": lambda path: _rewritten(path, _cell("INVERSE_MASS", 1, 0, 1.0)),
    "shape of no body": lambda path: _rewritten(path, lambda h, a: a["parts"].__setitem__((1, 3), 99)),
    "shape of a negative body": lambda path: _rewritten(path, lambda h, a: a["parts"].__setitem__((1, 3), -1)),
    "two shapes of a row": lambda path: _rewritten(path, lambda h, a: a["parts"].__setitem__((1, 0), 0)),
    "bounds nowhere": lambda path: _rewritten(path, _cell("BOUNDS", 2, 0, np.nan)),
    "contact of no shape": lambda path: _rewritten(path, _cell("CONTACT", 0, c.SHAPE_A, 1000)),
    "contact of a negative shape": lambda path: _rewritten(path, _cell("CONTACT", 0, c.SHAPE_B, -3)),
    "contact of another body": lambda path: _rewritten(path, _cell("CONTACT", 0, c.BODY_B, 0)),
    "contact the wrong way round": lambda path: _rewritten(path, _swapped),
    "contact of many points": lambda path: _rewritten(path, _cell("CONTACT", 0, c.POINTS, 5)),
    "event of no body": lambda path: _rewritten(path, _put(1, "table EVENTS", np.full((1, 8), 77))),
    "apart from no body": lambda path: _rewritten(path, _put(1, "table EXCLUDED", np.full((1, 2), 77))),
    "joint of no body": lambda path: _rewritten(path, _cell("JOINT", 0, j.BODY_B, 77)),
    "joint of one body": lambda path: _rewritten(path, _cell("JOINT", 0, j.BODY_B, 0)),
    "joint of no kind": lambda path: _rewritten(path, _cell("JOINT", 0, j.JOINT_KIND, 77)),
    "joint about axis 9": lambda path: _rewritten(path, _cell("JOINT", 0, j.PIVOT, 9)),
    "joint of other angles": lambda path: _rewritten(path, _cell("JOINT", 0, j.ANGULAR, j.SWING_TWIST)),
    "joint of rows that are not": lambda path: _rewritten(path, _put(1, "table JOINT_AXES", np.zeros((5, 16)))),
    "links that are not": lambda path: _rewritten(path, _put(1, "table LINK_NUMBERS", np.zeros((0, 232)))),
    "half a substep": lambda path: _rewritten(path, _cell("SETTINGS", 0, settings_.SUBSTEPS, 0.5)),
    "no substeps": lambda path: _rewritten(path, _cell("SETTINGS", 0, settings_.SUBSTEPS, 0.0)),
    "step that is not over": lambda path: _rewritten(path, _cell("STEP_STATUS", 0, STATUS, 1)),
}


def _cell(table, row, column, value):
    return lambda header, arrays: arrays[f"table {table}"].__setitem__((row, column), value)


def _swapped(header, arrays):
    rows = arrays["table CONTACT"]
    rows[0, [c.SHAPE_A, c.SHAPE_B, c.BODY_A, c.BODY_B]] = rows[0, [c.SHAPE_B, c.SHAPE_A, c.BODY_B, c.BODY_A]]


def landed():
    """Balls on a mesh, one of which hangs on the ground, after some steps: there are contacts, and a joint is arranged."""
    world = kd.World()
    world.add_mesh([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2), (0, 2, 3)])
    world.add_box((1, 1, 1), position=(0, 0, 0.5))
    ball = world.add_sphere(0.3, position=(3, 0, 2))
    world.add_hinge(None, ball, anchor=(3, 0, 3), axis=(0, 1, 0))
    world.advance(STEP, 3)
    assert len(world.tables.array(CONTACT)) > 0
    return world


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE.keys())
def test_a_file_that_is_no_world_is_refused(damage, tmp_path):
    path = landed().save(tmp_path / "world.npz")
    damage(path)
    with pytest.raises(FileFormatError, match="is not a kickdrift world") as caught:
        kd.load_world(path)
    assert "World.save" in str(caught.value)


@pytest.mark.parametrize("name", [name for name, table in TABLES.items() if table.whole and name not in MADE])
def test_no_table_of_whole_numbers_is_trusted(name, tmp_path):
    path = landed().save(tmp_path / "world.npz")
    rows = np.full((1, TABLES[name].width), 10**6)
    _rewritten(path, lambda h, a: a.update({f"table {name}": np.full_like(a[f"table {name}"], 10**6)}))
    with np.load(path) as file:
        empty = file[f"table {name}"].size == 0
    if empty:
        _rewritten(path, _put(1, f"table {name}", rows))
    with pytest.raises(FileFormatError, match="is not a kickdrift world"):
        kd.load_world(path)


@pytest.mark.parametrize(
    ("column", "value"),
    [(PAIR_PARTICLES + 3, 50), (PAIR_PARTICLES, -1), (PAIR_FACES + 1, 64), (PAIR_KIND, 3), (PAIR_KIND, -1)],
)
def test_pairs_of_cloths_in_a_file_are_checked(column, value, tmp_path):
    world = kd.World(gravity=(0, 0, 0))
    for k in range(2):
        world.add_cloth_grid((0.5, 0.5), (5, 5), position=(0, 0, 0.008 * k), thickness=0.01)
    world.step(0.01)
    path = world.save(tmp_path / "world.npz")
    kd.load_world(path)

    def damage(_header, arrays):
        arrays["table CLOTH_PAIR"][3, column] = value

    _rewritten(path, damage)
    with pytest.raises(FileFormatError, match=f"table CLOTH_PAIR has {value} in column"):
        kd.load_world(path)
    _rewritten(path, lambda _header, arrays: arrays.update({"table CLOTH_SEARCH": np.zeros((0, 16))}))
    with pytest.raises(FileFormatError, match="table PARTICLE_PATH has 50 rows"):
        kd.load_world(path)


def test_a_file_damaged_anywhere_is_refused(tmp_path):
    path = balls().save(tmp_path / "world.npz")
    whole = path.read_bytes()
    generator = np.random.default_rng(0)
    for place in generator.integers(0, len(whole), 60):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << int(generator.integers(8))
        path.write_bytes(damaged)
        try:
            world = kd.load_world(path)
        except FileFormatError:
            continue
        assert state(world) == state(balls())  # the bit was one that says nothing, such as a date


def test_files_of_other_sorts_say_what_they_are(tmp_path, rolled):
    recording, world = rolled
    with pytest.raises(FileFormatError, match=r"is a world, not a recording; read it with kickdrift\.load_world"):
        kd.load(world.save(tmp_path / "world.npz"))
    with pytest.raises(FileFormatError, match="is not a kickdrift world"):
        kd.load_world(recording.save(tmp_path / "recording.npz"))
    _rewritten(tmp_path / "world.npz", _put(0, "format", "kickdrift world 3"))
    with pytest.raises(FileFormatError, match=r"'kickdrift world 3', but this version of kickdrift reads"):
        kd.load_world(tmp_path / "world.npz")
    with pytest.raises(FileFormatError, match="cannot be read"):
        kd.load_world(tmp_path / "nothing.npz")
    with pytest.raises(FileFormatError, match="cannot be read"):
        kd.load_world(tmp_path)
    for bad in (tmp_path / "missing" / "world.npz", "", tmp_path / "..", "a\0b"):
        with pytest.raises(FileFormatError):
            world.save(bad)


lengths = st.floats(1e-3, 1e3)


@given(
    st.lists(
        st.one_of(
            st.builds(Sphere, lengths),
            st.builds(Capsule, lengths, lengths),
            st.builds(Box, st.tuples(lengths, lengths, lengths)),
            st.just(Plane()),
        ),
        max_size=8,
    )
)
@settings(max_examples=50, deadline=None)
def test_shapes_come_back_from_a_catalogue(shapes):
    catalogue = Catalogue()
    places = [catalogue.place(shape) for shape in shapes]
    made = shapes_of(json.loads(json.dumps(catalogue.words)), catalogue.numbers)
    assert [made[place] for place in places] == shapes
    assert len(made) == len(set(shapes))


def test_hulls_meshes_and_height_fields_come_back_from_a_catalogue():
    hull = Hull(np.random.default_rng(0).normal(size=(20, 3)))
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.1]], [[0, 1, 2], [1, 3, 2]])
    field = HeightField(np.random.default_rng(1).normal(size=(3, 4)), (0.5, 0.7))
    catalogue = Catalogue()
    for shape in (hull, mesh, field, hull):
        catalogue.place(shape)
    made = shapes_of(catalogue.words, catalogue.numbers)
    assert [type(shape) for shape in made] == [Hull, Mesh, HeightField]
    assert all(np.array_equal(a.numbers, b.numbers) for a, b in zip(made, (hull, mesh, field), strict=True))


# Recordings


def test_a_recording_has_the_states_and_what_they_conserve(rolled):
    recording, _ = rolled
    world = balls()
    assert recording.t.size == 31
    assert (recording.n_steps, recording.step, recording.success) == (30, 0.5 / 30, True)
    for row in range(recording.t.size):
        assert recording.t[row] == pytest.approx(world.time, abs=1e-15)
        assert np.array_equal(recording.x[row], world.position)
        assert np.array_equal(recording.v[row], world.velocity)
        assert np.array_equal(recording.orientation[row], world.orientation)
        assert np.array_equal(recording.angular_velocity[row], world.angular_velocity)
        assert recording.energy[row] == world.energy().total
        assert recording.derived["kinetic energy"][row] == world.energy().kinetic
        assert np.array_equal(recording.invariants["momentum"][row], world.momentum())
        assert np.array_equal(recording.invariants["angular momentum"][row], world.angular_momentum())
        world.step(recording.step)
    assert recording.energy[-1] < recording.energy[0]


def test_a_whole_number_of_equal_steps_covers_the_duration():
    world = kd.World()
    world.add_sphere(radius=0.1)
    recording = world.run(1.0, 0.3, save_every=3)
    assert (recording.step, recording.n_steps) == (0.25, 4)
    assert recording.t.tolist() == [0.0, 0.75, 1.0]
    again = world.run(0.3, 0.1)
    assert (again.n_steps, again.t[0]) == (3, 1.0)
    assert again.t[-1] == 1.3
    assert world.time == pytest.approx(1.3, abs=1e-15)
    # Free fall by the midpoint rule is exact.
    assert again.x[-1, 1, 2] == pytest.approx(-0.5 * 9.81 * 1.3**2, rel=1e-14)


def test_runs_in_chunks_have_the_bits_of_single_steps():
    one, other = balls(), balls()
    recording = one.run(1.0, STEP, save_every=13)
    other.advance(STEP, 60)
    assert np.array_equal(recording.x[-1], other.position)
    assert recording.t.size == 6
    assert one.n_steps == 60


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ((0.0, 0.1), "duration=0.0 must be positive"),
        ((-1.0, 0.1), "duration=-1.0 must be positive"),
        ((np.nan, 0.1), "duration=nan must be positive"),
        ((np.inf, 0.1), "duration=inf must be positive"),
        (("1", 0.1), "duration='1' must be positive"),
        ((None, 0.1), "duration=None must be positive"),
        (([1.0], 0.1), r"duration=\[1.0\] must be positive"),
        ((1j, 0.1), "duration=1j must be positive"),
        ((1.0, 0.0), "step=0.0 must be positive"),
        ((1.0, -0.1), "step=-0.1 must be positive"),
        ((1.0, np.nan), "step=nan must be positive"),
        ((1.0, "fast"), "step='fast' must be positive"),
        ((1.0, 1.5), "step=1.5 is larger than duration=1.0"),
        ((1.0, 0.1, 0), "save_every=0 must be a positive whole number"),
        ((1.0, 0.1, -2), "save_every=-2 must be"),
        ((1.0, 0.1, 1.5), "save_every=1.5 must be"),
        ((1.0, 0.1, True), "save_every=True must be"),
        ((1e9, 1e-3), r"save_every=None keeps all \d+ steps, .* GiB, .*; give save_every=\d+ or more"),
    ],
)
def test_runs_that_cannot_be_are_refused_before_any_work(arguments, why):
    world = balls()
    with pytest.raises(ArgumentError, match=why):
        world.run(*arguments)
    assert world.n_steps == 0


def test_an_interruption_keeps_what_is_done(monkeypatch):
    shown = []

    def show(self, step, seconds):
        shown.append(step)
        if step >= 20:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Bar, "show", show)
    world = balls()
    recording = world.run(2.0, STEP, save_every=7)
    assert recording.status is kd.Outcome.INTERRUPTED
    assert not recording.success
    assert recording.n_steps == shown[-1] == world.n_steps < 120
    assert recording.message == (
        f"{kd.Outcome.INTERRUPTED.value} It ends at t={world.time!r}, after {world.n_steps} of 120 steps."
    )
    assert recording.t[-1] == pytest.approx(world.time, abs=1e-14)
    assert np.array_equal(recording.x[-1], world.position)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    other = balls()
    other.advance(STEP, world.n_steps)
    assert state(other) == state(world)  # no step was left half done


def test_an_ignored_interruption_stays_ignored(monkeypatch):
    monkeypatch.setattr(Bar, "show", lambda self, step, seconds: signal.raise_signal(signal.SIGINT))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert balls().run(0.2, STEP).success
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def test_a_body_lost_to_infinity_ends_a_recording():
    def kicked(t, force):
        if t >= 0.2:
            force[2, 0] = np.inf

    world = kd.World()
    for k in range(3):
        world.add_sphere(radius=0.1, position=(k, 0, 0))
    world.add_force(kicked)
    recording = world.run(1.0, 0.02, save_every=4)
    assert recording.status is kd.Outcome.NOT_FINITE
    assert recording.n_steps == world.n_steps
    assert recording.n_steps in (9, 10)  # the tenth step ends at 0.2
    assert "body 2 was lost to infinity" in recording.message
    assert f"after {recording.n_steps} of 50 steps" in recording.message
    assert recording.t.tolist() == pytest.approx([0.0, 0.08, 0.16, 0.02 * recording.n_steps])
    assert np.isfinite(recording.x).all()
    assert recording.x[-1, 2, 2] == pytest.approx(-0.5 * 9.81 * recording.t[-1] ** 2, rel=1e-13)
    assert world.time == pytest.approx(recording.t[-1])


def test_recordings_come_back_from_files(rolled, tmp_path):
    recording, _ = rolled
    loaded = kd.load(recording.save(tmp_path / "balls"))
    assert type(loaded) is kd.Recording
    for name in ("t", "x", "v", "orientation", "angular_velocity", "energy"):
        assert np.array_equal(getattr(loaded, name), getattr(recording, name))
    for name in ("status", "message", "step", "n_steps", "wall_time", "about"):
        assert getattr(loaded, name) == getattr(recording, name)
    assert loaded.report() == recording.report()
    assert [part.body for part in loaded.appearance.parts] == [part.body for part in recording.appearance.parts]
    copy = pickle.loads(pickle.dumps(recording))
    assert np.array_equal(copy.orientation, recording.orientation)


@pytest.mark.parametrize(
    "change",
    [
        lambda h, a: a.update(orientation=a["orientation"][:, 1:]),
        lambda h, a: a.update(angular_velocity=a["angular_velocity"][1:]),
        lambda h, a: a.update(kinds=a["kinds"][1:]),
        lambda h, a: a["parts"].__setitem__((0, 0), 99),
        lambda h, a: a["parts"].__setitem__((0, 1), 99),
        lambda h, a: a.update(places=a["places"][1:]),
        lambda h, a: a.pop("rods"),
        lambda h, a: h.update(status="FINE"),
        lambda h, a: h.pop("shapes"),
    ],
)
def test_a_file_that_is_no_recording_is_refused(change, rolled, tmp_path):
    path = rolled[0].save(tmp_path / "recording.npz")
    _rewritten(path, change)
    with pytest.raises(FileFormatError, match="is not a kickdrift solution"):
        kd.load(path)
    path = rolled[0].save(tmp_path / "recording.npz")
    _tampered(path, lambda h, a: a["x"].__setitem__((0, 1, 0), 99.0))
    with pytest.raises(FileFormatError, match="changed after it was written"):
        kd.load(path)


def test_a_recording_is_a_labelled_dataset(rolled):
    pytest.importorskip("xarray")
    recording, _ = rolled
    data = recording.to_xarray()
    assert data["x"].dims == ("time", "body", "space")
    assert data["orientation"].dims == ("time", "body", "quaternion")
    assert data["orientation"].sel(quaternion="w", body=3)[-1] == recording.orientation[-1, 3, 0]
    assert data["angular_velocity"].attrs["units"] == "rad/s"
    assert data["energy"].attrs["units"] == "J"


def test_the_report_says_how_fast_and_what_became_of_the_energy(rolled):
    recording, _ = rolled
    lines = dict(line.split("  ", 1) for line in recording.report().splitlines())
    facts = {name: value.strip() for name, value in lines.items()}
    assert facts["bodies"] == "6 that move, 7 shapes"
    assert facts["span"] == "0 to 0.5 s"
    assert "times real time" in facts["wall time"]
    assert facts["energy"].startswith(f"{recording.energy[0]:.6g} to {recording.energy[-1]:.6g} J")
    assert facts["outcome"] == "The end of the duration was reached."


def test_overlap_and_joint_gaps_are_those_of_the_shapes():
    world = kd.World(gravity=(0, 0, 0))
    world.add_plane()
    ball = world.add_sphere(radius=0.5, position=(0, 0, 0.49))
    joint = world.add_ball_joint(ball, None, anchor=(0, 0, 2))
    recording = world.run(STEP, STEP)
    assert recording.derived["overlap"][-1] == pytest.approx(0.5 - recording.x[-1, ball.index, 2], abs=1e-15)
    assert recording.derived["joint gap"].max() < 1e-3
    world.joints.remove(joint)
    world.position[ball.index] = (0.3, 0, 0.4)
    world.velocity[:] = 0.0
    assert world.run(STEP, STEP).derived["joint gap"].tolist() == [0.0, 0.0]
    strings = cradle()
    assert strings.run(STEP, STEP).derived["joint gap"][0] < 1e-12
    strings.position[3, 2] -= 0.05  # the last ball hangs straight down
    assert strings.run(1e-9, 1e-9).derived["joint gap"][0] == pytest.approx(0.05, abs=1e-4)
    pair = kd.World()
    ends = [pair.add_sphere(radius=0.1, position=(k, 0, 0)) for k in range(2)]
    pair.add_ball_joint(*ends, anchor=(0.5, 0, 0))
    pair.position[2] += (0.0, 0.03, 0.04)
    assert pair.run(1e-9, 1e-9).derived["joint gap"][0] == pytest.approx(0.05, abs=1e-14)


# Loops of one's own


def test_compilation_within_a_run_is_not_counted(monkeypatch):
    """A ball at 100 m/s needs stages that a box at rest does not."""
    calls = []

    def compiled_slowly(*arguments):
        calls.append(arguments)
        time.sleep(0.5)
        compile_step(*arguments)

    compile_step = stepping.compile_step
    monkeypatch.setattr(stepping, "compile_step", compiled_slowly)
    world = kd.World()
    world.add_plane()
    world.add_box((0.2, 0.2, 0.2), position=(0, 0, 0.1), density=100.0)
    world.add_sphere(0.02, position=(0, 0, 3), velocity=(0, 0, -100), mass=1.0)
    recording = world.run(0.2, STEP)
    assert len(calls) >= 2
    assert world.compile_time > 1.0
    assert recording.wall_time < world.compile_time / 2


def test_worlds_and_recordings_name_their_contents():
    world = balls()
    assert repr(world).startswith("<World at t=0 s: ")
    assert repr(world.run(0.5, STEP)).startswith("<Recording of a world of ")


def test_a_recorded_loop_is_a_run():
    world, other = balls(), balls()
    run = world.run(0.5, STEP, save_every=4, contact_points=True)
    with other.record(save_every=4, contact_points=True) as recording:
        for _ in range(10):
            other.step(run.step)
        other.advance(run.step, 20)
    assert type(recording) is kd.Recording
    for name in ("x", "v", "orientation", "angular_velocity", "energy"):
        assert np.array_equal(getattr(recording, name), getattr(run, name))
    assert np.array_equal(recording.contact_points, run.contact_points, equal_nan=True)
    assert recording.contact_points.shape[1] > 0
    assert recording.t == pytest.approx(run.t, abs=1e-14)
    assert np.array_equal(recording.derived["overlap"], run.derived["overlap"])
    for name in ("status", "step", "n_steps", "n_force_evaluations", "about"):
        assert getattr(recording, name) == getattr(run, name)
    assert state(world)["POSE"] == state(other)["POSE"]
    assert 0.0 < recording.wall_time < 60.0
    other.step(STEP)
    assert recording.n_steps == 30


def test_recording_changes_nothing(tmp_path):
    def swing(world):
        world.advance(0.01, 30)
        world.advance(0.005, 7)
        return [event.begins for event in world.events], state(world)

    first, second = cradle(), cradle()
    with first.record(save_every=10) as recording:
        recorded = swing(first)
    assert recorded == swing(second)
    assert recording.t == pytest.approx([0, 0.1, 0.2, 0.3, 0.335], abs=1e-12)
    assert recording.step == 0.01
    assert recording.n_steps == 37
    loaded = kd.load(recording.save(tmp_path / "cradle"))
    assert np.array_equal(loaded.x, recording.x)
    assert "37, 5 states kept" in recording.report()


def test_bodies_that_come_are_not_there_before_and_those_that_go_after():
    world = balls()
    gone = world.bodies.handle(2)
    with world.record() as recording:
        world.step(STEP)
        late = world.add_sphere(0.1, position=(9, 9, 9), name="late")
        world.advance(STEP, 99)
        world.remove(gone)
        world.step(STEP)
    assert recording.x.shape == (102, 9, 3)
    assert np.isnan(recording.x[:2, late.index]).all()
    assert np.isfinite(recording.x[2:, late.index]).all()
    assert np.isfinite(recording.x[:-1, gone.index]).all()
    assert np.isnan(recording.x[-1, gone.index]).all()
    assert np.isfinite(recording.energy).all()
    assert recording.row("late") == late.index
    report = recording.report()
    assert "displacement" in report
    assert re.search(
        "^stages of substeps  .*begin forces, kick, .*warm start, solve, .*drift, relax", report, re.MULTILINE
    )


def swung():
    world = kd.World()

    def wind(t, force):
        for row in range(1, len(force)):
            force[row, 0] += math.sin(3.0 * t)

    world.add_force(wind)
    world.add_plane()
    world.add_sphere(0.5, position=(0, 0, 0.6))
    return world


def test_ctrl_c_in_many_steps_takes_effect_between_two_of_them():
    world, same = swung(), swung()
    world.step(1 / 60)  # compiled before
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        world.advance(1 / 60, 10**12)
    assert 1 < world.n_steps < 10**9
    same.step(1 / 60)
    same.advance(1 / 60, world.n_steps - 1)
    assert np.array_equal(world.position, same.position)
    assert world.time == same.time


def thrown(seed):
    """Return a world of bodies that fall on each other; many ask for the direct solver in a step that is done in parts."""
    rng, world = np.random.default_rng(seed), kd.World()
    world.add_plane()
    for k in range(5):
        kind = {
            "orientation": rng.normal(size=4),
            "density": 10 ** rng.uniform(2, 4),
            "restitution": rng.choice([0.0, 0.5]),
        }
        kind["position"] = (*rng.uniform(-0.3, 0.3, 2), 0.5 + 0.7 * k)
        if k % 2:
            world.add_box(rng.uniform(0.05, 0.6, 3), **kind)
        else:
            world.add_cylinder(rng.uniform(0.1, 0.3), rng.uniform(0.05, 0.6), **kind)
    return world


def test_many_steps_at_once_single_ones_and_copies_have_the_same_bits():
    for seed in range(20):
        whole, single, halfway, recorded = (thrown(seed) for _ in range(4))
        whole.advance(STEP, 120)
        for _ in range(120):
            single.step(STEP)
        halfway.advance(STEP, 60)
        copied, snapshot = copy.deepcopy(halfway), halfway.snapshot()
        halfway.advance(STEP, 30)
        halfway.restore(snapshot)
        recorded.run(2.0, STEP, save_every=60)
        halfway.advance(STEP, 60)
        copied.advance(STEP, 60)
        for world in (single, halfway, copied, recorded):
            assert np.array_equal(world.velocity, whole.velocity), seed


def test_chunks_of_steps_change_no_bit(monkeypatch):
    whole, cut, recorded = swung(), swung(), swung()
    whole.advance(1 / 60, 500)
    monkeypatch.setattr("kickdrift.core.interruption._CHUNK_SECONDS", 1e-9)
    cut.advance(1 / 60, 500)
    with recorded.record(save_every=7):
        recorded.advance(1 / 60, 500)
    runs = [swung() for _ in range(3)]
    runs[0].run(500 / 60, 1 / 60)
    runs[1].run(500 / 60, 1 / 60, save_every=100)
    monkeypatch.setattr("kickdrift.core.interruption._CHUNK_SECONDS", 0.01)
    runs[2].run(500 / 60, 1 / 60, save_every=500)
    for world in (cut, recorded, *runs):
        assert np.array_equal(world.velocity, whole.velocity)
        assert (world.time, world.n_steps) == (whole.time, whole.n_steps)


@pytest.mark.parametrize(
    ("error", "status"), [(ZeroDivisionError, kd.Outcome.FAILED), (KeyboardInterrupt, kd.Outcome.INTERRUPTED)]
)
def test_a_loop_that_ends_by_an_error_keeps_what_was_done(error, status):
    world = balls()
    kept = []

    def loop():
        with world.record(save_every=2) as recording:
            kept.append(recording)
            world.advance(STEP, 5)
            raise error("enough")

    with pytest.raises(error):
        loop()
    recording = kept[0]
    assert recording.status is status
    assert recording.message.endswith("after 5 steps. enough")
    assert len(recording.t) == 4
    world.advance(STEP, 2)
    with world.record() as again:  # it can be recorded again
        pass
    assert (again.n_steps, len(again.t), again.step) == (0, 1, 0.0)
    assert again.success


def test_a_body_lost_in_a_recorded_loop():
    world = balls()
    kept = []

    def loop():
        with world.record(save_every=2) as recording:
            kept.append(recording)
            world.advance(STEP, 3)
            world.velocity[1] = 1e308
            world.advance(1e9, 5)

    with pytest.raises(kd.LostBodyError):
        loop()
    recording = kept[0]
    assert recording.status is kd.Outcome.NOT_FINITE
    assert recording.n_steps == 3
    assert np.isfinite(recording.x[-1]).all()
    assert recording.t[-1] == world.time


def test_recordings_that_cannot_be():
    world = balls()
    then = world.snapshot()
    for every in (0, -1, 1.5, True, "all", None):
        with pytest.raises(ArgumentError, match="save_every"), world.record(save_every=every):
            pass
    with world.record() as recording:
        with pytest.raises(AttributeError, match=r"x is available once the block of World\.record has ended"):
            recording.x  # noqa: B018
        with pytest.raises(ArgumentError, match="already being recorded"), world.record():
            pass
        with pytest.raises(ArgumentError, match="cannot go back in time"):
            world.restore(then)
        world.step(STEP)
    with pytest.raises(AttributeError, match="no 'colour'"):
        recording.colour  # noqa: B018
    assert recording.n_steps == 1
    world.restore(then)


def test_a_snapshot_before_the_first_step_of_a_new_joint_changes_no_bits():
    ends = []
    for looks in (False, True):
        world = kd.World()
        ball, other = (world.add_sphere(0.1, mass=1.0, position=(x, 0, 0)) for x in (1.0, 1.15))
        world.advance(1 / 60, 5)
        world.add_hinge(None, ball, anchor=(0, 0, 0), axis=(0, 1, 0))
        world.add_ball_joint(ball, other, anchor=other.position)  # they overlap, and are parted
        if looks:
            world.snapshot()
        world.advance(1 / 60, 5)
        ends.append(world.position[ball.index].tobytes())
        assert not world.touching
    assert ends[0] == ends[1]


def _fallen_dolls(seed):
    """Three dolls of ten parts and five boxes, in a heap."""
    rng, world, across = np.random.default_rng(seed), kd.World(), (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)
    world.add_plane(friction=0.6)
    for k in range(3):
        x, z = 0.1 * k + rng.normal() * 0.1, 2.5 + 2 * k
        torso = world.add_capsule(0.12, 0.4, position=(x, 0, z), mass=30.0)
        head = world.add_sphere(0.11, position=(x, 0, z + 0.45), mass=5.0)
        world.add_ball_joint(torso, head, anchor=(x, 0, z + 0.34))
        for side in (1, -1):
            arm = world.add_capsule(0.05, 0.3, position=(x + side * 0.35, 0, z + 0.2), orientation=across, mass=2.0)
            world.add_ball_joint(torso, arm, anchor=(x + side * 0.15, 0, z + 0.2))
            hand = world.add_capsule(0.04, 0.25, position=(x + side * 0.7, 0, z + 0.2), orientation=across, mass=1.2)
            world.add_hinge(arm, hand, anchor=(x + side * 0.54, 0, z + 0.2), axis=(0, 1, 0), limits=(-2, 2))
            thigh = world.add_capsule(0.07, 0.4, position=(x + side * 0.1, 0, z - 0.55), mass=8.0)
            world.add_ball_joint(torso, thigh, anchor=(x + side * 0.1, 0, z - 0.3))
            shin = world.add_capsule(0.06, 0.4, position=(x + side * 0.1, 0, z - 1.1), mass=4.0)
            world.add_hinge(thigh, shin, anchor=(x + side * 0.1, 0, z - 0.82), axis=(1, 0, 0), limits=(0, 2))
    for k in range(5):
        size, place = rng.uniform(0.1, 0.4, 3), (rng.normal() * 0.4, rng.normal() * 0.4, 0.5 + 0.5 * k)
        world.add_box(tuple(size), position=place, density=500.0, restitution=0.3)
    return world


def test_full_tables_do_not_change_contacts_of_bodies_on_known_paths(tmp_path):
    world = _fallen_dolls(6)
    world.advance(1 / 60, 40)
    world.save(tmp_path / "heap.npz")
    loaded, contacts = kd.load_world(tmp_path / "heap.npz"), []
    for again in (world, loaded):
        again.advance(1 / 60, 1)
        contacts.append(again.tables.count(CONTACT))
        again.advance(1 / 60, 12)
    assert contacts[0] == contacts[1]
    assert np.array_equal(world.position, loaded.position)
