"""The commands and their options: help texts, and the handling of errors."""

import warnings
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import kickdrift
from kickdrift.cli import BAD_INPUT, INTERRUPTED, help_texts
from kickdrift.cli.output import say
from kickdrift.cli.plan import Options, is_scene, make_plan
from kickdrift.core.errors import ArgumentError, KickdriftError


class _Commands(TyperGroup):
    """Turns warnings, and the errors that kickdrift raises on purpose, into one line, and the latter into an exit code."""

    def invoke(self, ctx: Any) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _say_warning
                return super().invoke(ctx)
        except KickdriftError as error:
            say(str(error))
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt:
            say("interrupted.")
            raise typer.Exit(INTERRUPTED) from None


def _say_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    say(f"warning: {message}")


app = typer.Typer(
    cls=_Commands, no_args_is_help=True, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)

DurationOption = Annotated[
    str | None,
    typer.Option(help="Duration: a number in the system's unit of time, or with a unit, such as '10 years'."),
]
YearsOption = Annotated[str | None, typer.Option(help="The duration in years of 365.25 days.")]
StepOption = Annotated[str | None, typer.Option(help="Largest step: a number, or with a unit: 0.01, '0.5 day', '6 h'.")]
OutputOption = Annotated[
    Path, typer.Option(help="Folder for the files, created if missing; files of the same name are replaced.")
]


class Catalogue(StrEnum):
    """The choices of `list`."""

    METHODS = "methods"
    SYSTEMS = "systems"
    SCENES = "scenes"


def _version(wanted: bool) -> None:
    if wanted:
        print(f"kickdrift {kickdrift.__version__}")
        raise typer.Exit


@app.callback(help=help_texts.KICKDRIFT)
def _kickdrift(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Structure-preserving integration for mechanics."""


@app.command(help=help_texts.RUN, short_help="Run a system or a scene, report on it, save and plot it.")
def run(
    target: Annotated[
        str, typer.Argument(help="A system or a scene (see: kickdrift list systems, list scenes), or a .toml file.")
    ],
    duration: DurationOption = None,
    years: YearsOption = None,
    step: StepOption = None,
    method: Annotated[str | None, typer.Option(help="A method (see: kickdrift list methods), or auto.")] = None,
    bodies: Annotated[
        str | None, typer.Option(help="Bodies of the solar system to include, such as 'Sun,Earth,Jupiter'.")
    ] = None,
    save_every: Annotated[
        str | None, typer.Option(help="Number of steps between stored states; by default some 4000 states are stored.")
    ] = None,
    output: OutputOption = Path("kickdrift-output"),
    checkpoint: Annotated[
        Path | None,
        typer.Option(help="Folder for checkpoints: the same command resumes from the last one, bit for bit."),
    ] = None,
    save_to: Annotated[
        Path | None,
        typer.Option(
            help="Zarr folder, such as run.zarr, to which all states are written during the run, instead of the files."
        ),
    ] = None,
    film: Annotated[bool, typer.Option("--film", help="Also write an animation of a scene, <scene>.gif.")] = False,
    contacts: Annotated[
        bool,
        typer.Option("--contacts", help="On the page of a scene, show the points at which bodies press on each other."),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False,
) -> None:
    """Run a system or a scene, report on it, and write <name>.npz and <name>.png, and of a scene <name>.html."""
    options = Options(duration, years, step, method, bodies, save_every)
    if is_scene(target):
        from kickdrift.cli.scene import make_scene_plan, run_scene

        raise typer.Exit(
            run_scene(make_scene_plan(target, options), output, quiet, checkpoint, save_to, film, contacts)
        )
    for option, given in (("film", film), ("contacts", contacts)):
        if given:
            raise ArgumentError(
                f"--{option} applies to scenes, but {target!r} is not one (see: kickdrift list scenes); leave it out."
            )
    from kickdrift.cli.run import run as do

    raise typer.Exit(do(make_plan(target, options), output, quiet, checkpoint, save_to))


@app.command(help=help_texts.COMPARE, short_help="Compare three Euler methods and Stoermer-Verlet.")
def compare(
    system: Annotated[str, typer.Argument(help="A system (see: kickdrift list systems), or a .toml file.")],
    duration: DurationOption = None,
    years: YearsOption = None,
    step: StepOption = None,
    output: OutputOption = Path("kickdrift-output"),
) -> None:
    """Run explicit, implicit and semi-implicit Euler and Stoermer-Verlet with the same step."""
    from kickdrift.cli.compare import compare as do

    options = Options(duration, years, step)
    raise typer.Exit(do(make_plan(system, options, comparison=True), output))


@app.command(help=help_texts.VIEW, short_help="Show a scene, a robot or a saved run in the browser.")
def view(
    target: Annotated[
        str, typer.Argument(help="A scene (see: kickdrift list scenes), a robot's .xml or .urdf, or a .npz file.")
    ],
    step: Annotated[str | None, typer.Option(help="Step of a world, in seconds.")] = None,
    port: Annotated[int, typer.Option(help="Port of this machine; 0 chooses a free one.")] = 8080,
) -> None:
    """Run a world in the browser, or write the page of a run that was saved."""
    from kickdrift.cli.view import view as do

    raise typer.Exit(do(target, step, port))


@app.command("compile", help=help_texts.COMPILE, short_help="Compile code in advance, so that runs start at once.")
def compile_(quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False) -> None:
    """Compile code in advance, so that runs start at once."""
    from kickdrift.cli.compiling import compile_all

    raise typer.Exit(compile_all(quiet))


@app.command("list", help=help_texts.LIST, short_help="List the methods, the systems or the scenes.")
def list_(what: Annotated[Catalogue, typer.Argument(help="The catalogue to list.")]) -> None:
    """List the methods, the systems or the scenes; lines are not truncated if the output is piped."""
    from kickdrift.cli import listing

    lists = {
        Catalogue.METHODS: listing.list_methods,
        Catalogue.SYSTEMS: listing.list_systems,
        Catalogue.SCENES: listing.list_scenes,
    }
    lists[what]()
