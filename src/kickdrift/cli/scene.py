"""``kickdrift run`` for scenes: a world that is run, kept, reported, drawn and filmed."""

from dataclasses import dataclass, fields, replace
from pathlib import Path

from kickdrift.cli.output import exit_code, prepare_folder, say
from kickdrift.cli.plan import Options, save_every
from kickdrift.cli.times import parse_time
from kickdrift.core.errors import ArgumentError, MissingExtraError
from kickdrift.engine.announcing import compiling_announced
from kickdrift.scenes.worlds.catalogue import SCENES
from kickdrift.world.recordings.recording import Recording
from kickdrift.world.world import World

_FOR_SYSTEMS = ("method", "bodies", "years")
_LONGEST_FILM = 20.0  # seconds; longer runs are shown faster


@dataclass(frozen=True)
class ScenePlan:
    """A run of a scene: times in seconds."""

    name: str
    duration: float
    step: float
    save_every: int | None


def make_scene_plan(name: str, options: Options) -> ScenePlan:
    """Work out how to run a scene, without doing any of it.

    Raises
    ------
    ArgumentError
        For options that cannot be used.
    """
    for field in fields(options):
        value = getattr(options, field.name)
        if field.name in _FOR_SYSTEMS and value is not None:
            raise ArgumentError(f"--{field.name}={value!r} applies to systems, and {name!r} is a scene; leave it out.")
    scene = SCENES[name]
    duration, step = (
        default if text is None else parse_time(f"--{which}", text, "s")
        for which, text, default in (("duration", options.duration, scene.duration), ("step", options.step, scene.step))
    )
    for which, value in (("duration", duration), ("step", step)):
        if value < 0.0:
            given = getattr(options, which)
            raise ArgumentError(
                f"--{which}={given!r} must be positive: contacts cannot be integrated backwards in time."
            )
    if step > duration:
        raise ArgumentError(f"--step={step!r} is larger than the duration, {duration!r} s; give a smaller one.")
    return ScenePlan(name, duration, step, save_every(options, None))


def run_scene(
    plan: ScenePlan,
    folder: Path,
    quiet: bool,
    checkpoint: Path | None = None,
    save_to: Path | None = None,
    film: bool = False,
    contacts: bool = False,
) -> int:
    """Run a scene, write ``<scene>.npz``, ``.png``, ``.html`` and, on request, ``.gif`` into a folder; return the exit code.

    A run that ends early is still written and reported. One with a folder for checkpoints resumes from the last, and one
    whose rows go to disk writes nothing else.
    """
    if contacts and save_to is not None:
        raise ArgumentError(
            f"--contacts keeps points in memory, and --save-to={str(save_to)!r} has no room for them; leave one of them out."
        )
    if save_to is None:
        prepare_folder(folder)
    world = SCENES[plan.name].make()
    if not quiet:
        say(f"{plan.name}, {plan.duration:g} s in steps of {plan.step:g}")
    _compile_ahead(world, plan.step, quiet)
    progress = False if quiet else None
    recording = world.run(
        plan.duration,
        plan.step,
        plan.save_every,
        progress,
        checkpoint=checkpoint,
        save_to=save_to,
        contact_points=contacts,
    )
    recording = replace(recording, about=replace(recording.about, system=plan.name))
    if save_to is not None:
        if not quiet:
            print(f"{recording.report()}\n\nwritten: {save_to}")
        return exit_code(recording.status, recording.message)
    try:
        kept = recording.save(folder / f"{plan.name}.npz")
    finally:
        if not quiet:
            print(recording.report())
    if not quiet:
        say("drawing ...")
    files = [kept, folder / f"{plan.name}.png"]
    recording.plot(files[-1])
    if film:
        files.append(folder / f"{plan.name}.gif")
        _film(recording, files[-1], quiet)
    page = _page(recording, folder / f"{plan.name}.html")
    if not quiet:
        print(f"\nwritten: {', '.join(map(str, files))}")
        print(f"open {page}" if page else "for an interactive page: pip install 'kickdrift[viewer]'")
    return exit_code(recording.status, recording.message)


def _compile_ahead(world: World, step: float, quiet: bool) -> None:
    """Compile the functions that the first step of a world needs, before the run is timed."""
    before = world.snapshot()
    with compiling_announced(False if quiet else None):
        world.step(step)
    world.restore(before)


def _film(recording: Recording, path: Path, quiet: bool) -> None:
    simulated = float(recording.t[-1] - recording.t[0])
    speed = max(1.0, simulated / _LONGEST_FILM)
    recording.animate(path, speed=speed, progress=False if quiet else None)


def _page(recording: Recording, path: Path) -> Path | None:
    """Write the page for the browser, if viser is installed."""
    try:
        return recording.to_html(path)
    except MissingExtraError:
        return None
