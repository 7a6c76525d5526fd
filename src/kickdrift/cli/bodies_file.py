"""A user's own bodies: a TOML file, with the bodies in it or in a CSV file beside it.

The file is parsed and checked, never executed. Every error names the file and the key, or the line of the CSV file.
"""

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PureWindowsPath
from typing import Any, NoReturn

from pydantic import ValidationError

from kickdrift.cli.bodies_models import TABLES, BodiesFile, Run
from kickdrift.cli.bodies_table import read_bodies_table, read_text
from kickdrift.core.errors import ArgumentError, FileFormatError, unknown_name
from kickdrift.systems import System, nbody

Location = tuple[str | int, ...]


@dataclass(frozen=True)
class OwnBodies:
    """The system that a file describes, and its settings for the run."""

    system: System
    run: Run


def load_bodies_file(path: Path) -> OwnBodies:
    """Read a user's bodies.

    Parameters
    ----------
    path : Path
        The TOML file.

    Raises
    ------
    FileFormatError
        For a file that cannot be read, or is not such a file; the sentence names the place in it.
    """
    source = read_text(path)
    try:
        content: dict[str, Any] = tomllib.loads(source)
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"{path}: not a TOML file: {str(error).rstrip('.')}.") from None
    if not isinstance(content.get("bodies"), str):
        return _checked(path, content, lambda location: f"{path}: {_spelt(location)}")
    table = _beside(path, content["bodies"])
    content["bodies"], lines = read_bodies_table(table)

    def place(location: Location) -> str:
        match location:
            case "bodies", int(row), *within:
                return f"{table}:{lines[row]}: {_spelt(within)}"
        return f"{path}: {_spelt(location)}"

    return _checked(path, content, place)


def _spelt(location: Sequence[str | int]) -> str:
    """Spell a place as Python does: ``bodies[1].mass``."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")


def _beside(path: Path, name: str) -> Path:
    # A Windows path takes both kinds of slashes and drives apart.
    if name in ("", ".", "..") or PureWindowsPath(name).name != name or not name.isprintable():
        raise FileFormatError(
            f"{path}: bodies={name!r} must be the plain name of a CSV file beside {path.name}; move the file into its"
            " folder."
        )
    return path.parent / name


def _checked(path: Path, content: dict[str, Any], place: Callable[[Location], str]) -> OwnBodies:
    try:
        file = BodiesFile.model_validate(content)
    except ValidationError as error:
        _complain(error, place)
    seen: set[str] = set()
    for i, body in enumerate(file.bodies):
        if body.name in seen:
            raise FileFormatError(f"{place(('bodies', i, 'name'))}={body.name!r} is already in use; give another.")
        seen.add(body.name)
    if file.units.given and file.G is None:
        raise FileFormatError(
            f"{path}: [units] is given without G, and G = 1 does not hold in these units; add G at the top of the"
            " file, such as G = 39.4769264 for au, years and solar masses, or leave [units] out."
        )
    try:
        return OwnBodies(_system(file, path.stem), file.run)
    except ArgumentError as error:
        raise FileFormatError(f"{path}: {error}") from None


def _complain(error: ValidationError, place: Callable[[Location], str]) -> NoReturn:
    """Raise one error as a sentence with its place: an unknown key before what is missing for it."""
    first = min(error.errors(include_url=False), key=lambda one: one["type"] != "extra_forbidden")
    location = first["loc"]
    key = str(next(part for part in reversed(location) if isinstance(part, str)))
    tables = tuple(part for part in location[: location.index(key)] if isinstance(part, str))
    table, model = TABLES[tables]
    if first["type"] == "extra_forbidden":
        others = [where for where, other in TABLES.values() if key in other.model_fields]
        known = str(unknown_name("key", key, model.model_fields))
        sentence = f": the key belongs to {others[0]}; move it there." if others else f": in {table}, {known}"
    elif first["type"] == "missing":
        sentence = f" is missing; add it to {table}."
    else:
        reason = str(first.get("ctx", {}).get("error", first["msg"])).rstrip(".")
        value = repr(first["input"])
        end = "" if reason.endswith("?") else "."
        sentence = f"={value if len(value) < 60 else value[:60] + '...'}: {reason[0].lower()}{reason[1:]}{end}"
    raise FileFormatError(f"{place(location)}{sentence}") from None


def _system(file: BodiesFile, name: str) -> System:
    system = nbody(
        masses=[body.mass for body in file.bodies],
        x0=[body.position for body in file.bodies],
        v0=[body.velocity for body in file.bodies],
        G=1.0 if file.G is None else file.G,
        softening=file.softening,
        names=[body.name for body in file.bodies],
    )
    time, length, mass = file.units.time, file.units.length, file.units.mass
    units = {"t": time, "x": length, "v": f"{length}/{time}" if length and time else ""}
    of_quantities = {"energy": "{m} {l}^2/{t}^2", "momentum": "{m} {l}/{t}", "angular momentum": "{m} {l}^2/{t}"}
    labels = {key: text.format(m=mass, l=length, t=time) for key, text in of_quantities.items()}
    quantities = {
        key: replace(quantity, unit=labels[key]) if time and length and mass else quantity
        for key, quantity in system.quantities.items()
    }
    return replace(system, name=name, quantities=quantities, units={key: unit for key, unit in units.items() if unit})
