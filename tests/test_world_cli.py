"""``kickdrift run`` and ``list`` for scenes: files, reports, exit codes, and what is refused."""

import signal
import time

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import kickdrift as kd
from kickdrift import cli
from kickdrift.cli import scene
from kickdrift.cli.app import app
from kickdrift.cli.plan import Options
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.progress import Bar
from kickdrift.scenes.worlds.catalogue import SCENES, Scene
from kickdrift.systems import catalogue


@pytest.fixture
def folder(tmp_path, small_pictures, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments], prog_name="kickdrift")


def test_a_scene_is_run_reported_kept_drawn_and_filmed(folder):
    result = call("run", "bouncing-disk", "--duration", 0.5, "--film", "--contacts")
    assert result.exit_code == cli.DONE, result.output
    output = folder / "kickdrift-output"
    assert {path.name for path in output.iterdir()} == {f"bouncing-disk.{end}" for end in ("npz", "png", "gif", "html")}
    assert result.stderr.splitlines()[0] == "kickdrift: bouncing-disk, 0.5 s in steps of 0.01"
    kept = kd.load(output / "bouncing-disk.npz")
    assert kept.about.system == "bouncing-disk"
    assert (kept.n_steps, kept.t[0], kept.t[-1]) == (50, 0.0, 0.5)
    # Thrown upwards at 5 m/s from the floor; free flight is exact.
    assert kept.x[-1, 2, 2] == pytest.approx(0.1 + 5 * 0.5 - 0.5 * 9.81 * 0.25, rel=1e-13)
    assert kept.report() in result.stdout
    for fact in ("wall time", "times real time", "energy", "momentum", "outcome", "written: "):
        assert fact in result.stdout
    with Image.open(output / "bouncing-disk.gif") as film:
        assert film.n_frames == 13
    with Image.open(output / "bouncing-disk.png") as picture:
        assert np.ptp(np.asarray(picture.convert("L"))) > 100


def test_options_choose_duration_step_and_folder(folder):
    result = call("run", "bouncing-disk", "--duration", "0.1 s", "--step", 0.004, "--save-every", 5, "--output", "a/b")
    assert result.exit_code == cli.DONE, result.output
    kept = kd.load(folder / "a" / "b" / "bouncing-disk.npz")
    assert (kept.step, kept.n_steps) == (0.004, 25)
    assert kept.t.size == 6


def test_quiet_writes_files_only(folder):
    result = call("run", "bouncing-disk", "--duration", 0.1, "--quiet")
    assert (result.exit_code, result.output) == (cli.DONE, "")
    assert len(list((folder / "kickdrift-output").iterdir())) == 3


def test_compiling_is_announced_and_is_no_part_of_the_run(folder, monkeypatch):
    monkeypatch.setattr("kickdrift.world.step.compiling.missing", lambda jobs: list(jobs)[:2])
    monkeypatch.setattr("kickdrift.world.step.compiling.compile_together", lambda jobs: time.sleep(0.1))
    monkeypatch.setattr("kickdrift.engine.announcing._A_MOMENT", 0.05)
    result = call("run", "bouncing-disk", "--duration", 0.1)
    lines = result.stderr.splitlines()
    assert lines[1] == "kickdrift: compiling 2 functions of the step once on this machine ..."
    assert lines[2].startswith("kickdrift: compiled in ")
    kept = kd.load(folder / "kickdrift-output" / "bouncing-disk.npz")
    assert (kept.t[0], kept.n_steps) == (0.0, 10)


def test_long_runs_are_filmed_faster(folder, monkeypatch):
    monkeypatch.setattr(scene, "_LONGEST_FILM", 0.2)
    assert call("run", "bouncing-disk", "--duration", 0.8, "--quiet", "--film").exit_code == cli.DONE
    with Image.open(folder / "kickdrift-output" / "bouncing-disk.gif") as film:
        assert film.n_frames == 6


def test_an_interrupted_scene_is_written_all_the_same(folder, monkeypatch):
    show = Bar.show

    def interrupt(self, step, seconds):
        if self._unit == "step" and step >= 5:
            signal.raise_signal(signal.SIGINT)
        show(self, step, seconds)

    monkeypatch.setattr(Bar, "show", interrupt)
    result = call("run", "bouncing-disk", "--duration", 1)
    assert result.exit_code == cli.INTERRUPTED
    kept = kd.load(folder / "kickdrift-output" / "bouncing-disk.npz")
    assert kept.status is kd.Outcome.INTERRUPTED
    assert 5 <= kept.n_steps < 100
    assert kept.message in result.stderr
    assert len(list((folder / "kickdrift-output").iterdir())) == 3


def test_a_scene_that_loses_a_body_is_a_run_that_failed(folder, monkeypatch):
    def thrown():
        world = kd.World()
        ball = world.add_sphere(radius=0.1)

        def pull(t, force):
            if t > 0.05:
                force[1, 0] = np.inf

        world.add_force(pull)
        assert ball.index == 1
        return world

    monkeypatch.setitem(SCENES, "bouncing-disk", Scene(thrown, 1.0, 0.01, "a ball is lost"))
    result = call("run", "bouncing-disk")
    assert result.exit_code == cli.FAILED
    assert "body 1 was lost to infinity" in result.stderr
    assert not kd.load(folder / "kickdrift-output" / "bouncing-disk.npz").success


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (("run", "pyramd"), "TARGET='pyramd' is unknown; did you mean 'pyramid'"),
        (("run", "dominos"), "did you mean 'dominoes'"),
        (("run", "keppler"), "did you mean 'kepler'"),
        (("compare", "pyramid"), "'pyramid' is a scene, and methods are compared on systems"),
        (
            ("run", "pyramid", "--method", "leapfrog"),
            "--method='leapfrog' applies to systems, and 'pyramid' is a scene",
        ),
        (("run", "kepler", "--film"), "--film applies to scenes, but 'kepler' is not one"),
        (("run", "kepler", "--contacts"), "--contacts applies to scenes, but 'kepler' is not one"),
        (
            ("run", "pyramid", "--contacts", "--save-to", "rows"),
            "--contacts keeps points in memory, and --save-to='rows'",
        ),
        (("run", "pyramid", "--years", "1"), "--years='1' applies to systems"),
        (("run", "pyramid", "--bodies", "Sun"), "--bodies='Sun' applies to"),
        (("run", "pyramid", "--duration", "-1"), "--duration='-1' must be positive"),
        (("run", "pyramid", "--duration", "0"), "--duration='0' must be finite and not zero"),
        (("run", "pyramid", "--duration", "long"), "--duration='long' is not a time"),
        (("run", "pyramid", "--duration", "3 parsec"), "the unit 'parsec' is unknown"),
        (("run", "pyramid", "--step", "-0.1"), "--step='-0.1' must be positive"),
        (("run", "pyramid", "--step", "10"), "--step=10.0 is larger than the duration, 5.0 s"),
        (("run", "pyramid", "--save-every", "0"), "--save-every='0' must be a positive whole number"),
        (("run", "pyramid", "--output", "/proc/nothing"), "--output='/proc/nothing' cannot be written"),
    ],
)
def test_what_cannot_be_run_is_one_sentence(folder, arguments, why):
    result = call(*arguments)
    assert result.exit_code == cli.BAD_INPUT
    assert why in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert result.stdout == ""
    assert not any(path.suffix for path in folder.rglob("*"))


def test_times_have_units():
    plan = scene.make_scene_plan("pyramid", Options(duration="0.5 min", step="0.0001 h"))
    assert (plan.duration, plan.step) == (30.0, pytest.approx(0.36))
    with pytest.raises(ArgumentError, match="must be positive"):
        scene.make_scene_plan("pyramid", Options(duration="-2 s"))


def test_scenes_are_listed(folder):
    result = call("list", "scenes")
    assert result.exit_code == cli.DONE
    head, *rows = result.stdout.splitlines()
    assert head.split()[0] == "name"
    assert [row.split()[0] for row in rows] == list(SCENES)
    for name in ("pyramid", "bouncing-disk", "ragdolls", "robot-arm", "cradle", "dominoes"):
        assert name in SCENES


def test_no_scene_has_the_name_of_a_system():
    assert not set(SCENES) & set(catalogue())


@pytest.mark.parametrize("name", SCENES)
def test_every_scene_makes_a_world_that_can_be_looked_at(name):
    chosen = SCENES[name]
    world = chosen.make()
    assert isinstance(world, kd.World)
    assert 0 < chosen.step <= chosen.duration / 100
    assert len(world.bodies.moving()) + world.tables.count(kd.world.tables.CLOTH) >= 1
