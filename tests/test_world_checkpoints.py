"""Runs of worlds that are kept: the same call goes on with the same bits."""

import numpy as np
import pytest
from killing import killed_after
from typer.testing import CliRunner

import kickdrift as kd
from kickdrift.cli.app import app
from kickdrift.engine import checkpoints

STEP = 1 / 60


def pushed(t, position, force):
    """Push all bodies to and fro."""
    for body in range(1, len(force)):
        force[body, 0] += 0.5 * np.cos(3.0 * t)


def pile(forced=True):
    world = kd.World()
    world.add_plane(normal=(0, 0, 1), friction=0.5)
    for k in range(4):
        world.add_box(size=(0.5, 0.5, 0.5), position=(0.1 * k, 0, 0.3 + 0.7 * k), mass=1.0, restitution=0.3)
    if forced:
        world.add_force(pushed)
    return world


def broken_off(monkeypatch, folder, after, make=pile):
    """Run until so many checkpoints are written, and die before the next one is."""
    with killed_after(after, checkpoints.Checkpoints, "write", monkeypatch):
        run(make(), folder)


def run(world, folder=None, duration=3.0, **others):
    kept = {} if folder is None else {"checkpoint": folder, "checkpoint_every": 50}
    return world.run(duration, **{"step": STEP, "save_every": 7, **kept, **others})


def same(one, other):
    for name in ("t", "x", "v", "orientation", "angular_velocity"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert np.array_equal(one.contact_points, other.contact_points, equal_nan=True)
    for mapping in ("invariants", "derived"):
        for name, values in getattr(other, mapping).items():
            assert np.array_equal(getattr(one, mapping)[name], values), name
    assert (one.n_steps, one.n_force_evaluations, one.status) == (
        other.n_steps,
        other.n_force_evaluations,
        other.status,
    )


def test_a_world_goes_on_with_the_same_bits(tmp_path, monkeypatch):
    left_alone, goes_on = pile(), pile()
    whole = run(left_alone)
    broken_off(monkeypatch, tmp_path / "run", 2)
    on = run(goes_on, tmp_path / "run")
    same(on, whole)
    assert "It resumed from step 100" in on.message
    assert "It resumed from step 100" in on.report()
    assert goes_on.time == left_alone.time
    left_alone.advance(STEP, 30)
    goes_on.advance(STEP, 30)
    assert np.array_equal(goes_on.position, left_alone.position)
    same(run(pile(), tmp_path / "run"), whole)  # which is done


def test_points_of_contacts_go_on_too(tmp_path, monkeypatch):
    whole = run(pile(), contact_points=True)
    assert np.isfinite(whole.contact_points[-1]).all(axis=1).sum() >= 4
    with killed_after(2, checkpoints.Checkpoints, "write", monkeypatch):
        run(pile(), tmp_path / "run", contact_points=True)
    with pytest.raises(kd.ArgumentError, match="another contact_points"):
        run(pile(), tmp_path / "run")
    on = run(pile(), tmp_path / "run", contact_points=True)
    assert "It resumed from step 100" in on.message
    same(on, whole)


def test_a_longer_and_a_shorter_duration_go_on(tmp_path):
    run(pile(), tmp_path / "run", checkpoint_keep=None)
    same(run(pile(), tmp_path / "run", 4.0), run(pile(), None, 4.0))
    same(run(pile(), tmp_path / "run", 2.5), run(pile(), None, 2.5))


@pytest.mark.parametrize(
    ("make", "others", "words"),
    [
        (lambda: pile(forced=False), {}, "another"),
        (kd.World, {}, "another"),
        (pile, {"step": 1 / 50}, "another step"),
        (pile, {"save_every": 8}, "another save_every"),
    ],
)
def test_a_checkpoint_of_another_world_is_refused(make, others, words, tmp_path, monkeypatch):
    broken_off(monkeypatch, tmp_path / "run", 1)
    with pytest.raises(kd.ArgumentError, match=words):
        run(make(), tmp_path / "run", **others)


def test_that_of_a_solution_is_refused_too(tmp_path):
    kd.solve(kd.systems.kepler(), (0.0, 1.0), step=0.1, checkpoint=tmp_path / "run")
    with pytest.raises(kd.ArgumentError, match="another problem"):
        run(pile(), tmp_path / "run", step=0.1, duration=1.0)


def test_a_checkpoint_that_is_cut_short_is_passed_over(tmp_path, monkeypatch):
    broken_off(monkeypatch, tmp_path / "run", 3)
    newest = tmp_path / "run" / "step-000000000000150.npz"
    newest.write_bytes(newest.read_bytes()[:1000])
    on = run(pile(), tmp_path / "run")
    same(on, run(pile()))
    assert "A newer checkpoint is damaged" in on.message


def test_what_cannot_be_written_ends_the_run(tmp_path, monkeypatch):
    def full(self, step, *arguments):
        raise kd.core.errors.FileFormatError("No space left on device.")

    monkeypatch.setattr(checkpoints.Checkpoints, "write", full)
    recording = run(pile(), tmp_path / "run")
    assert recording.status is kd.Outcome.NOT_WRITTEN
    assert "No space left" in recording.message
    assert recording.n_steps == 50
    assert recording.t[-1] == 50 * STEP


@pytest.mark.parametrize(
    ("others", "words"),
    [
        ({"checkpoint": 3}, "is not a path"),
        ({"checkpoint": "x", "checkpoint_every": 0}, "checkpoint_every=0 must"),
        ({"checkpoint_every": 5}, "without checkpoint"),
        ({"contact_points": 3}, "contact_points=3 must"),
        ({"contact_points": True, "save_to": "run.zarr"}, "leave one of the two out"),
    ],
)
def test_arguments_that_cannot_be_are_refused(others, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kd.ArgumentError, match=words):
        run(pile(), **others)


def test_a_recording_says_that_the_world_goes_on():
    recording = run(pile())
    with pytest.raises(kd.KickdriftError, match=r"world\.run"):
        recording.continue_to(5.0)
    with pytest.raises(kd.KickdriftError, match="known only at its steps"):
        recording(0.1)


@pytest.mark.parametrize("target", ["kepler", "bouncing-disk"])
def test_the_same_command_goes_on(target, tmp_path, monkeypatch, small_pictures):
    monkeypatch.setattr(checkpoints, "_FIRST", 40)
    monkeypatch.setattr(checkpoints, "_SECONDS", 0.0)
    command = ["run", target, "--duration", "2.0", "--step", "0.01", "--quiet"]
    kept = ["--checkpoint", str(tmp_path / "kept")]
    with killed_after(2, checkpoints.Checkpoints, "write", monkeypatch):
        CliRunner().invoke(app, [*command, *kept, "--output", str(tmp_path / "one")])
    outputs = [tmp_path / "one", tmp_path / "other"]
    for output, more in zip(outputs, (kept, []), strict=True):
        result = CliRunner().invoke(app, [*command, *more, "--output", str(output)])
        assert result.exit_code == 0, result.output
    on, whole = (kd.load(output / f"{target}.npz") for output in outputs)
    assert "It resumed from step" in on.message
    assert np.array_equal(on.x, whole.x)
    assert np.array_equal(on.t, whole.t)
