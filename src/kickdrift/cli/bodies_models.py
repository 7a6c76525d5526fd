"""The format of a bodies file: a strict model for each of its tables."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from kickdrift import methods
from kickdrift.cli.times import TIMES
from kickdrift.core.errors import unknown_name
from kickdrift.engine.method_selection import AUTO

LENGTHS = "m", "km", "au", "ly", "pc", "kpc", "earth radius", "solar radius"
MASSES = "g", "kg", "t", "lunar mass", "earth mass", "jupiter mass", "solar mass"

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)

    @field_validator("*")
    @classmethod
    def _printable(cls, value: Any) -> Any:
        # These texts are printed on the terminal, where control characters are commands.
        if isinstance(value, str) and not value.isprintable():
            raise ValueError("it contains unprintable characters; remove them.")
        return value


class Body(_Strict):
    """A body at the start."""

    name: Annotated[str, Field(min_length=1)]
    mass: Annotated[float, Field(ge=0)]
    position: Vector
    velocity: Vector


class Units(_Strict):
    """Of the file's numbers, which are not converted; durations may be given in other units of time."""

    time: str = ""
    length: str = ""
    mass: str = ""

    @field_validator("*")
    @classmethod
    def _known(cls, value: str, info: ValidationInfo) -> str:
        known = {"time": TIMES, "length": LENGTHS, "mass": MASSES}[str(info.field_name)]
        if value and value not in known:
            raise ValueError("the unit " + str(unknown_name("unit", value, known)).removeprefix(f"unit={value!r} "))
        return value

    @property
    def given(self) -> bool:
        """Whether there is any."""
        return bool(self.time or self.length or self.mass)


class Run(_Strict):
    """Defaults for the run; times in the file's own unit."""

    duration: float | None = None
    step: Annotated[float, Field(gt=0)] | None = None
    method: str | None = None
    save_every: Annotated[int, Field(ge=1)] | None = None

    @field_validator("method")
    @classmethod
    def _known(cls, value: str | None) -> str | None:
        if value not in (None, AUTO):
            methods.get(str(value))
        return value


class BodiesFile(_Strict):
    """The whole file."""

    bodies: Annotated[list[Body], Field(min_length=1)]
    G: Annotated[float, Field(gt=0)] | None = None
    softening: Annotated[float, Field(ge=0)] = 0.0
    units: Units = Units()
    run: Run = Run()


TABLES: dict[tuple[str, ...], tuple[str, type[BaseModel]]] = {
    (): ("the top of the file", BodiesFile),
    ("units",): ("[units]", Units),
    ("run",): ("[run]", Run),
    ("bodies",): ("[[bodies]]", Body),
}
