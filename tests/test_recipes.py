"""The recipes of CONTRIBUTING: each is followed to the letter in a copy of the package, which then does what it says."""

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest
from numba.core.caching import _CacheLocator

import kickdrift
from kickdrift.world.tables import Tables

ROOT = Path(__file__).parent.parent
PACKAGE = Path(kickdrift.__file__).parent


def recipe(name):
    """The text of a recipe."""
    text = (ROOT / "CONTRIBUTING.md").read_text()
    (found,) = re.findall(rf"^- \*\*A new {name}\*\* (.*?)(?=^- |^$)", text, re.MULTILINE | re.DOTALL)
    return found


def link(source, target):
    try:
        os.link(source, target)
    except OSError:  # another disk
        shutil.copy2(source, target)


def compiled_code(folder):
    """Files of compiled code of the modules in a folder of the package, wherever Numba keeps them."""
    if not numba.config.CACHE_DIR:
        return []  # beside the modules, and copied with them
    place = _CacheLocator.get_suitable_cache_subpath(str(folder / "__init__.py"))
    return Path(numba.config.CACHE_DIR, place).glob("*.nbc")


def bytecode(folder):
    """Files of bytecode of the modules in a folder of the package, wherever Python keeps them."""
    if sys.pycache_prefix is None:
        return []
    return Path(importlib.util.cache_from_source(str(folder / "__init__.py"))).parent.glob("*.pyc")


class House:
    """A copy of the package, with the compiled code that there is, in which only files named by a recipe change."""

    def __init__(self, folder, name):
        self.folder, self.recipe = folder, recipe(name)
        shutil.copytree(PACKAGE, folder / "kickdrift", copy_function=link)
        for source in {path.parent for path in PACKAGE.rglob("__init__.py")}:
            for file in (*compiled_code(source), *bytecode(source)):
                beside = folder / "kickdrift" / source.relative_to(PACKAGE) / "__pycache__" / file.name
                beside.parent.mkdir(exist_ok=True)
                if not beside.exists():
                    link(file, beside)

    def add(self, path, text):
        """Write a new file in a folder that the recipe names."""
        assert f"`{Path(path).parent}/`" in self.recipe
        (self.folder / "kickdrift" / path).write_text(text)

    def line(self, path, before, text):
        """Write lines before others in a file that the recipe names."""
        assert f"`{path}`" in self.recipe
        file = self.folder / "kickdrift" / path
        old = file.read_text()
        assert old.count(before) == 1, before
        file.unlink()  # which is a link
        file.write_text(old.replace(before, text + before))

    def run(self, code):
        """What a process with this package says at the end, as JSON."""
        environment = {**os.environ, "PYTHONPATH": str(self.folder), "NUMBA_CACHE_DIR": "", "PYTHONPYCACHEPREFIX": ""}
        command = [sys.executable, "-W", "error", "-c", "import json, kickdrift as kd\n" + code]
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=300, check=False, env=environment, cwd=self.folder
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture
def house(request, tmp_path):
    return House(tmp_path, request.param)


DUFFING = '''"""Duffing's oscillator: x'' = -x - x^3."""

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.systems.system import Quantity, System, start


@compiled
def _acceleration(t, x, v, params, out):
    out[0] = -x[0] - params[0] * x[0] ** 3


@compiled
def _energy(t, x, v, params, out):
    out[0] = 0.5 * v[0] ** 2 + 0.5 * x[0] ** 2 + 0.25 * params[0] * x[0] ** 4


def duffing(stiffening=1.0):
    """Make one at rest."""
    return System(
        name="duffing", acceleration=_acceleration, x0=start(1.0), v0=start(0.0), params=np.array([stiffening]),
        quantities={"energy": Quantity(_energy)}, packaged=True,
    )
'''


@pytest.mark.parametrize("house", ["system"], indirect=True)
def test_a_new_system(house):
    house.add("systems/duffing.py", DUFFING)
    catalogue = "systems/__init__.py"
    house.line(catalogue, "from kickdrift.systems.first_order", "from kickdrift.systems.duffing import duffing\n")
    house.line(catalogue, '    "kepler": kepler,\n', '    "duffing": duffing,\n')
    code = """
s = kd.solve(kd.systems.get("duffing"), (0.0, 10.0), step=0.01, method="blanes-moan-srkn6b")
from typer.testing import CliRunner
from kickdrift.cli.app import app
listed = CliRunner().invoke(app, ["list", "systems"]).output
run = CliRunner().invoke(app, ["run", "duffing", "--duration", "1", "--step", "0.01", "--quiet"])
print(json.dumps([abs(s.energy[-1] - 0.75), float(s.x[-1]), "duffing" in listed, run.exit_code]))
"""
    off, x, listed, exit_code = house.run(code)
    assert off < 1e-9
    assert abs(x) < 1.0
    assert listed
    assert exit_code == 0


BRAKE = '''"""The flow of a brake, v' = -v, which is exact."""

import math

from kickdrift.core.compilation import unbound
from kickdrift.engine.flows.layout import change_of_v

add_to_v = unbound


def brake(t, h, x, v, params, work):
    """Multiply v by exp(-h)."""
    change, lost = change_of_v(v.size, work), math.expm1(-h)
    for i in range(v.size):
        change[i] = lost * v[i]
    add_to_v(v, 1.0, change, work)
'''


@pytest.mark.parametrize("house", ["flow"], indirect=True)
def test_a_new_flow(house):
    house.add("engine/flows/brake.py", BRAKE)
    letters, table = "methods/letter.py", "engine/flows/table.py"
    house.line(letters, '    ROTATE = "rotate"\n', '    BRAKE = "brake"\n')
    house.line(letters, '        ("kick", "drift", "rotate"),\n', '        ("kick", "drift", "brake"),\n')
    house.line(table, "    constraint_rows,\n    constraints,\n    damping,", "    brake,\n")
    house.line(table, '    "rotate": Flow(', '    "brake": Flow(brake.brake, moves_v=True),\n')
    code = """
import numpy as np
from kickdrift.methods import Kind, Letter, Method
from kickdrift.methods.words import word
half = "1/2"
letters = word((Letter.BRAKE, half), (Letter.KICK, half), (Letter.DRIFT, 1), (Letter.KICK, half), (Letter.BRAKE, half))
braking = Method(name="braking", order=2, word=letters, kind=Kind.NEWTONIAN, symmetric=True, source="a test")
ends = [kd.solve(lambda x: -2.0 * x, (0.0, 1.0), 1.0, 0.0, step=h, method=braking, compile=c).x[-1]
        for h, c in ((0.02, True), (0.01, True), (0.01, False))]
exact = np.exp(-0.5) * (np.cos(np.sqrt(1.75)) + 0.5 / np.sqrt(1.75) * np.sin(np.sqrt(1.75)))
print(json.dumps([float(end - exact) for end in ends]))
"""
    coarse, fine, interpreted = house.run(code)
    assert 3.9 < coarse / fine < 4.1  # of order 2 on x'' = -2 x - x'
    assert interpreted == fine


BEAD = '''"""Beads: balls that touch planes alone."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from kickdrift.core.compilation import compiled
from kickdrift.world.shapes import sphere
from kickdrift.world.shapes.kind_numbers import BEAD
from kickdrift.world.shapes.record import CENTRE, SOLID, Kind


@compiled
def touch_nothing(a, b, pose, margin, manifold):
    """Find no points."""
    return 0


@dataclass(frozen=True)
class Bead:
    """A bead of a radius in m."""

    radius: float
    kind: ClassVar[int] = BEAD

    @property
    def _ball(self):
        return sphere.Sphere(self.radius)

    @property
    def numbers(self):
        return self._ball.numbers

    @property
    def reach(self):
        return self.radius

    def mass_properties(self):
        return self._ball.mass_properties()


RECORD = Kind(
    number=BEAD, name="bead", sort=SOLID, shape=Bead, extent=sphere.RECORD.extent, ray=sphere.RECORD.ray, core=CENTRE
)
'''


@pytest.mark.parametrize("house", ["shape"], indirect=True)
def test_a_new_shape(house):
    house.add("world/shapes/bead.py", BEAD)
    pairs = "world/collision/narrow_phase/pair_dispatch.py"
    house.line("world/shapes/kind_numbers.py", "CONE = 9\n", "BEAD = 10\n")
    house.line("world/shapes/shape_kinds.py", "    cone.RECORD,\n", "    bead.RECORD,\n")
    house.line(
        "world/shapes/shape_kinds.py", "from kickdrift.world.shapes.record", "from kickdrift.world.shapes import bead\n"
    )
    house.line(pairs, "from kickdrift.world.shapes.kind_numbers", "from kickdrift.world.shapes import bead\n")
    house.line(pairs, "    (PLANE, CONE): frustum", "    (PLANE, 10): spheres.plane_sphere,\n")
    with_message = subprocess.run(
        [sys.executable, "-c", "import kickdrift.world.collision"],
        capture_output=True, text=True, check=False, cwd=house.folder,
        env={**os.environ, "PYTHONPATH": str(house.folder), "PYTHONPYCACHEPREFIX": ""},
    )  # fmt: skip
    assert "There is no contact function for triangle and bead" in with_message.stderr
    others = ("TRIANGLE", "SPHERE", "CAPSULE", "BOX", "HULL", "CYLINDER", "CONE", "10")
    house.line(
        pairs, "    (PLANE, CONE): frustum", "".join(f"    ({other}, 10): bead.touch_nothing,\n" for other in others)
    )
    code = """
from kickdrift.world.shapes.bead import Bead
world = kd.World()
world.add_plane()
body = world.add_body(Bead(0.5), position=(0.0, 0.0, 0.6))
world.add_sphere(0.5, position=(0.2, 0.0, 0.6))
for _ in range(60):
    world.step(1 / 60)
world.save("world.npz")
again = kd.load_world("world.npz")
hit = again.ray_cast((0.0, 0.0, 9.0), (0.0, 0.0, -20.0))
print(json.dumps([world.position[body.index, 2], world.position[body.index, 0], hit.point[2]]))
"""
    height, x, hit = house.run(code)
    assert height == pytest.approx(0.5, abs=5e-3)
    assert x == pytest.approx(0.0, abs=1e-9)  # it does not touch the ball in the same place
    assert hit == pytest.approx(1.0, abs=1e-2)


PISTON = '''"""The piston: a slider that turns, but not further than half a turn."""

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from kickdrift.world.argument_checks import direction, vector
from kickdrift.world.joints.limits_motors_options import FREE, LOCKED, Axis
from kickdrift.world.joints.record import Placement, Record, frame_along


@dataclass(frozen=True)
class Piston(Record):
    """Body b slides along an axis of body a, and turns about it."""

    anchor: ArrayLike
    axis: ArrayLike

    def placement(self):
        """Say where the joint is and what its axes do."""
        anchor = vector("anchor", self.anchor, 3)
        turn = Axis(False, (-math.pi / 2, math.pi / 2))
        frame = frame_along(direction("axis", self.axis))
        return Placement(anchor, anchor, frame, (LOCKED, LOCKED, FREE), (LOCKED, LOCKED, turn), principal=2)
'''


@pytest.mark.parametrize("house", ["joint"], indirect=True)
def test_a_new_joint(house):
    house.add("world/joints/piston.py", PISTON)
    for path in ("world/joints/joint_kinds.py", "world/joints/adding.py"):
        house.line(path, "from kickdrift.world.joints.record", "from kickdrift.world.joints.piston import Piston\n")
    house.line("world/joints/joint_kinds.py", "Gear)", "Piston, ")
    house.line("world/joints/adding.py", "    add_ball_joint = ", '    add_piston = _adds("add_piston", Piston)\n')
    code = """
world = kd.World()
bar = world.add_box((1.0, 0.2, 0.2), position=(0.0, 0.0, 0.0), angular_velocity=(0.0, 0.0, 9.0), velocity=(0.0, 1.0, 0.0))
joint = world.add_piston(None, bar, anchor=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0))
for _ in range(60):
    world.step(1 / 60)
world.save("world.npz")
again = kd.load_world("world.npz")
print(json.dumps([*world.position[bar.index], world.orientation[bar.index, 0], *again.position[bar.index]]))
"""
    x, y, z, cosine, *again = house.run(code)
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert z == pytest.approx(-0.5 * 9.81, rel=0.02)  # it falls freely
    assert cosine >= 0.7  # and has not turned any further
    assert again == [x, y, z]


STAGE = '''"""A wind that blows bodies along x, and how often it has blown."""

from kickdrift.core.compilation import compiled
from kickdrift.world.columns import column
from kickdrift.world.tables import FORCE, GUSTS, POSE, floats, integers, rows

BLOWN = column(GUSTS)


@compiled
def blow(t, h, world):
    """Add 1 N to what forces each body."""
    force = floats(world, FORCE)
    for body in range(1, rows(world, POSE)):
        force[body, 0] += 1.0
    integers(world, GUSTS)[0, BLOWN] += 1
'''


GUSTING = "    uses = uses._replace(forces=(*uses.forces, blow))\n"


@pytest.mark.parametrize("house", ["stage"], indirect=True)
def test_a_new_stage(house):
    house.add("world/wind.py", STAGE)
    place = len(Tables().block) // 3 - 1  # the last one is that of the view
    gusts = f"GUSTS = Table({place}, 1, whole=True)  # one row: see `kickdrift.world.wind`\n"
    house.line("world/tables.py", "\n_LAST = ", gusts)
    house.line("world/step/stage_order.py", "\nStages = tuple", "from kickdrift.world.wind import blow\n")
    house.line(
        "world/step/stage_order.py",
        "    return begin_forces, *when(uses.cloths, predict_loads), *uses.forces\n",
        GUSTING,
    )
    code = """
from kickdrift.world.tables import GUSTS
world = kd.World(gravity=(0.0, 0.0, 0.0))
body = world.add_sphere(1.0, mass=2.0)
world.tables.resize(GUSTS, 1)
world.advance(0.01, 100)
print(json.dumps([world.velocity[body.index, 0], int(world.tables.array(GUSTS)[0, 0]), world.substeps, str(world.word)]))
"""
    speed, blown, substeps, word = house.run(code)
    assert speed == pytest.approx(0.5)
    assert blown == 100 * (substeps + 1)  # the search for contacts asks once more
    assert "begin-forces blow kick" in word
