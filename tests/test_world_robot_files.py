"""The robots that come with MuJoCo and PyBullet: each is as MuJoCo knows it, or refused with the element that is wrong."""

import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")

from robot_references import falls, reference  # noqa: E402

from kickdrift.core.errors import FileFormatError  # noqa: E402
from kickdrift.io.robot_file import load_robot  # noqa: E402
from kickdrift.world.tables import INERTIA  # noqa: E402


def folder(package):
    found = find_spec(package)
    return Path(found.origin).parent if found and found.origin else None


def files():
    """All MJCF and URDF files; of the thousand that PyBullet has of one kind, `random_urdfs`, every fiftieth."""
    found = []
    for package in ("mujoco", "pybullet_data"):
        place = folder(package)
        if place is not None:
            found += [(place.parent, file) for end in ("xml", "urdf") for file in sorted(place.glob(f"**/*.{end}"))]
    alike = ["random_urdfs" in file.parts for _, file in found]
    rest = [pair for pair, like in zip(found, alike, strict=True) if not like]
    return rest + [pair for pair, like in zip(found, alike, strict=True) if like][::50]


FILES = files()
DATA = folder("pybullet_data")
needs_data = pytest.mark.skipif(DATA is None, reason="pybullet is not installed")

# Which show that not too much is refused.
LOADED = [
    "mjcf/humanoid.xml", "mjcf/humanoid_symmetric_no_ground.xml", "mjcf/ant.xml", "franka_panda/panda.urdf",
    "laikago/laikago.urdf", "mini_cheetah/mini_cheetah.urdf", "xarm/xarm6_robot.urdf", "humanoid/humanoid.urdf",
    "TwoJointRobot_wo_fixedJoints.urdf", "random_urdfs/000/000.urdf",
]  # fmt: skip

# XML that is wrong; joints, materials and meshes that there are not; numbers that no element has.
NAMED = re.compile(r"Element '\w+', line \d+|Element name '\w+'|Error opening file '[\w/.]+'")


@pytest.mark.parametrize(
    "path", [file for _, file in FILES], ids=[str(file.relative_to(place)) for place, file in FILES]
)
def test_every_file_is_as_in_mujoco_or_refused_by_name(path):
    refusal = None
    try:
        robot = load_robot(path)
    except FileFormatError as error:
        refusal = str(error)
    if refusal is not None:
        assert NAMED.search(refusal)
        assert DATA is None or path not in [DATA / name for name in LOADED]
        return
    world, rows = robot.world, robot.world.bodies.moving()
    assert np.isfinite(world.position).all()
    assert (world.tables.array(INERTIA)[rows, 0] > 0.0).all()
    try:
        model, data = reference(path)
    except ValueError:
        mended = ("inertia of body", "material", "MuJoCo does not compile")
        assert any(word in note for note in robot.notes for word in mended) or "package://" in path.read_text()
        return
    turning = [row for row in range(model.njnt) if int(model.jnt_type[row]) != int(mujoco.mjtJoint.mjJNT_FREE)]
    assert set(robot.joints) == {model.joint(row).name or f"joint {row}" for row in turning}
    assert set(robot.bodies) == {model.body(row).name or f"body {row}" for row in range(model.nbody)}
    free = np.flatnonzero(model.body_weldid > 0)
    masses = world.tables.array(INERTIA)[rows, 0]
    said = [
        name
        for note in robot.notes
        if "is added to the mass of what it moves" in note
        for name in re.findall("'([^']+)'", note)
    ]
    rotors = sum(model.dof_armature[model.joint(name).dofadr[0]] for name in said)
    assert masses.sum() == pytest.approx(model.body_mass[free].sum() + rotors, rel=1e-12)
    if free.size and not rotors:
        np.testing.assert_allclose(masses @ world.position[rows], model.body_mass[free] @ data.xipos[free], 0.0, 1e-9)
    for head in np.unique(model.body_weldid[free]):
        members = np.flatnonzero(model.body_weldid == head)
        centre = model.body_mass[members] @ data.xipos[members] / model.body_mass[members].sum()
        body = robot.bodies[model.body(head).name or f"body {head}"]
        np.testing.assert_allclose(world.position[body.index], centre, 0.0, 1e-3)


@needs_data
def test_nearly_all_are_loaded():
    assert {DATA / name for name in LOADED} <= {file for _, file in FILES}
    for name in ("mjcf/ant.xml", "random_urdfs/000/000.urdf"):
        assert load_robot(DATA / name, folder=DATA).bodies


def bare(path, tmp_path):
    """The file without what worlds do in their own way: contacts, limits, dry friction, rotors on what turns, motors."""
    spec = mujoco.MjSpec.from_file(str(path))
    for joint in spec.joints:
        joint.limited, joint.armature, joint.frictionloss = 0, 0.0, 0.0
    for geom in spec.geoms:
        geom.contype, geom.conaffinity = 0, 0
    for actuator in list(spec.actuators):
        spec.delete(actuator)
    spec.compile()
    result = tmp_path / "bare.xml"
    result.write_text(spec.to_xml())
    return result


@needs_data
@pytest.mark.parametrize(
    "name",
    [
        "mjcf/humanoid.xml",
        "mjcf/humanoid_symmetric_no_ground.xml",
        "mjcf/ant.xml",
        "pendulum5.urdf",
        "humanoid/humanoid.urdf",
    ],
)
def test_some_fall_as_in_mujoco(name, tmp_path):
    there, errors = falls(bare(DATA / name, tmp_path), 0.2, (40, 160))
    assert np.abs(there).max() > 5e-3
    assert errors[0] < 0.02 * np.abs(there).max()
    assert errors[1] < 0.4 * errors[0]
