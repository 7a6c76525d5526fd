"""``kickdrift view``: worlds that run in the browser, and recordings and solutions as pages that play."""

from pathlib import Path

from kickdrift.cli import DONE
from kickdrift.cli.output import say
from kickdrift.cli.times import parse_time
from kickdrift.core import archive
from kickdrift.core.errors import ArgumentError, unknown_name
from kickdrift.io import load
from kickdrift.io.world_file import load_world
from kickdrift.scale.ensemble_solution import EnsembleSolution
from kickdrift.scenes.worlds.catalogue import SCENES
from kickdrift.systems import catalogue
from kickdrift.world.settings import STEP
from kickdrift.world.tables import SETTINGS
from kickdrift.world.world import World

_ROBOTS = (".xml", ".urdf", ".mjcf")
_STEP, _ROBOTS_STEP = 1 / 60, 1 / 200  # s, by default


def view(target: str, step: str | None, port: int) -> int:
    """Show a scene, a robot or a world that was saved, until Ctrl-C, or write the page of a run that was; return the exit code.

    Raises
    ------
    KickdriftError
        For what cannot be shown, and for a port that is taken.
    """
    wanted = None if step is None else _step(step)
    suffix = Path(target).suffix.lower()
    if target in SCENES:
        return _run(SCENES[target].make(), wanted or SCENES[target].step, port)
    if suffix in _ROBOTS:
        if not Path(target).exists():  # said before a package is missing
            raise ArgumentError(f"TARGET={target!r} cannot be opened: No such file or directory.")
        from kickdrift.io.robot_file import load_robot  # MuJoCo takes a moment that the others need not wait

        robot = load_robot(target)
        for note in robot.notes:
            say(note)
        for name, joint in robot.joints.items():  # by which its slider is known
            joint.name = joint.name or name
        return _run(robot.world, wanted or _ROBOTS_STEP, port)
    if target in catalogue():
        raise ArgumentError(
            f"TARGET={target!r} is a system: kickdrift run {target}, and then kickdrift view kickdrift-output/{target}.npz."
        )
    if suffix != ".npz":
        if Path(target).exists():
            raise ArgumentError(f"TARGET={target!r} cannot be viewed; give a .npz, .xml or .urdf file.")
        raise unknown_name("TARGET", target, SCENES)
    if archive.format_of(target) == archive.WORLD:
        world = _load(target)
        return _run(world, wanted or float(world.tables.array(SETTINGS)[0, STEP]) or _STEP, port)
    if step is not None:
        raise ArgumentError(f"--step={step!r} applies to worlds, but {target!r} is a saved run; leave it out.")
    kept = load(target)
    if isinstance(kept, EnsembleSolution):
        raise ArgumentError(
            f"TARGET={target!r} is an ensemble; save one of its members, kd.load(path)[0].save(...), and view it."
        )
    print(f"open {kept.to_html(Path(target).with_suffix('.html'))}")
    return DONE


def _load(target: str) -> World:
    try:
        return load_world(target)
    except ArgumentError:  # without the functions that its forces were
        raise ArgumentError(
            f"TARGET={target!r} has forces or winds that are Python functions, which a file does not hold; in a script,"
            f" kd.load_world({target!r}, forces=[...]).view(1/60).wait() shows it with them."
        ) from None


def _step(text: str) -> float:
    step = parse_time("--step", text, "s")
    if step <= 0.0:
        raise ArgumentError(f"--step={text!r} must be positive: contacts cannot be integrated backwards in time.")
    return step


def _run(world: World, step: float, port: int) -> int:
    with world.view(step, port=port) as page:
        say("Ctrl-C ends it.")
        page.wait()
    return DONE
