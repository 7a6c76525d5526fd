"""From the arguments of the command line to a run that can be done, or one sentence why not."""

import os
import re
from dataclasses import dataclass
from pathlib import Path

from kickdrift.cli.times import parse_time
from kickdrift.core.errors import ArgumentError, unknown_name
from kickdrift.engine.method_selection import choose
from kickdrift.scenes import DEFAULTS, Defaults
from kickdrift.systems import System, catalogue, solar_system

SOLAR_SYSTEM = "solar-system"


@dataclass(frozen=True)
class Options:
    """The arguments of the command line; None for those not given."""

    duration: str | None = None
    years: str | None = None
    step: str | None = None
    method: str | None = None
    bodies: str | None = None
    save_every: str | None = None


@dataclass(frozen=True)
class Plan:
    """A run: times in the unit of the system."""

    system: System
    duration: float
    step: float
    method: str  # as asked for
    taken: str  # the name of the method that this is
    save_every: int | None
    jpl: bool  # whether JPL's positions are there to compare with

    @property
    def in_words(self) -> str:
        """What will be run."""
        unit = self.system.units.get("t", "")
        bodies = f" ({self.system.x0.shape[0]} bodies)" if "body" in self.system.coordinates else ""
        span = f"{self.duration:g} {unit}".strip()
        return f"{self.system.name}{bodies}, {span} in steps of {self.step:g}"


@dataclass(frozen=True)
class _Wishes:
    """Defaults for options that the command line does not set."""

    duration: float | None
    step: float | None
    method: str
    save_every: int | None = None


def is_scene(target: str) -> bool:
    """Whether a name is that of a scene, and not of a system or a file."""
    if target.lower().endswith(".toml") or target in catalogue():
        return False
    return target in _scenes()


def _scenes() -> tuple[str, ...]:
    from kickdrift.scenes.worlds.catalogue import SCENES  # worlds take half a second that systems need not wait

    return tuple(SCENES)


def make_plan(target: str, options: Options, *, comparison: bool = False) -> Plan:
    """Determine what to run, without doing any of it.

    Parameters
    ----------
    target : str
        Name of a system, or path of a bodies file.
    options : Options
    comparison : bool
        Whether several methods will run side by side, for which systems have defaults of their own.

    Raises
    ------
    KickdriftError
        For arguments that cannot be used.
    """
    is_file = target.lower().endswith(".toml")
    if options.bodies is not None and target != SOLAR_SYSTEM:
        raise ArgumentError(f"--bodies={options.bodies!r} applies only to {SOLAR_SYSTEM!r}; leave it out.")
    system, wishes = _own_bodies(Path(target)) if is_file else _catalogued(target, options, comparison)
    unit = system.units.get("t", "")
    duration = _duration(options, wishes, unit, target)
    step, method = _step(options, wishes, unit, target), wishes.method if options.method is None else options.method
    return Plan(
        system=system,
        duration=duration,
        step=step,
        method=method,
        taken=choose(method, None, system, 0.0, step, duration).name,
        save_every=save_every(options, wishes.save_every),
        jpl=target == SOLAR_SYSTEM,
    )


def _own_bodies(path: Path) -> tuple[System, _Wishes]:
    from kickdrift.cli.bodies_file import load_bodies_file  # pydantic takes 0.1 s that the other runs need not wait

    own = load_bodies_file(path)
    run = own.run
    return own.system, _Wishes(run.duration, run.step, run.method or Defaults().method, run.save_every)


def _catalogued(name: str, options: Options, comparison: bool) -> tuple[System, _Wishes]:
    systems = catalogue()
    if name not in systems:
        if os.path.exists(name):
            raise ArgumentError(
                f"TARGET={name!r} is neither a system nor a bodies file; give a .toml file or one of"
                f" {', '.join(systems)}."
            )
        if comparison and name in _scenes():
            raise ArgumentError(
                f"TARGET={name!r} is a scene, and methods are compared on systems: {', '.join(systems)}."
            )
        raise unknown_name("TARGET", name, [*systems, *(() if comparison else _scenes())])
    defaults = DEFAULTS.get(name, Defaults())
    duration, step = defaults.comparison if comparison else (defaults.duration, defaults.step)
    system = systems[name]() if options.bodies is None else solar_system(options.bodies.split(","))
    return system, _Wishes(duration, step, defaults.method)


def _duration(options: Options, wishes: _Wishes, unit: str, target: str) -> float:
    if options.years is not None:
        if options.duration is not None:
            raise ArgumentError(
                f"--years={options.years!r} and --duration={options.duration!r} are both given; leave one out."
            )
        return parse_time("--years", options.years, unit, bare="year")
    if options.duration is not None:
        return parse_time("--duration", options.duration, unit)
    return _given("duration", wishes.duration, target)


def _step(options: Options, wishes: _Wishes, unit: str, target: str) -> float:
    if options.step is None:
        return _given("step", wishes.step, target)
    step = parse_time("--step", options.step, unit)
    if step < 0:
        raise ArgumentError(f"--step={options.step!r} must be positive; the sign of the duration sets the direction.")
    return step


def save_every(options: Options, otherwise: int | None) -> int | None:
    """Return the number of steps between the states to keep.

    Raises
    ------
    ArgumentError
        If the option is not a positive whole number.
    """
    if options.save_every is None:
        return otherwise
    if not re.fullmatch(r"0*[1-9][0-9]{0,17}", options.save_every, re.ASCII):
        raise ArgumentError(f"--save-every={options.save_every!r} must be a positive whole number of steps.")
    return int(options.save_every)


def _given(name: str, value: float | None, target: str) -> float:
    if value is None:
        raise ArgumentError(
            f"--{name} is missing, and {target} does not set it; give the option, or add it to the [run] table of the"
            " file."
        )
    return value
