"""Solutions on disk: one ``.npz`` of plain arrays and one JSON text, which NumPy alone can open. No pickle."""

import json
import os
import tokenize
import zipfile
import zlib
from contextlib import suppress
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from kickdrift.core.errors import FileFormatError
from kickdrift.core.kinds import Kind
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.solution import Description, Invariants, Solution

_FORMAT = "kickdrift solution 1"
_INVARIANT, _DERIVED = "invariant: ", "derived: "
# What NumPy, zip and JSON raise on files that are damaged or not ours.
_FOREIGN = (
    *(ArithmeticError, AttributeError, EOFError, LookupError, MemoryError, NotImplementedError, RecursionError),
    *(RuntimeError, SyntaxError, TypeError, ValueError, zipfile.BadZipFile, zlib.error, tokenize.TokenError),
)


def save(solution: Solution, path: str | Path) -> Path:
    """Write a solution to a file, whole or not at all.

    Parameters
    ----------
    solution : Solution
    path : path
        Where; ``.npz`` is appended where it is missing. The folder must exist.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    FileFormatError
        If the file cannot be written there.
    """
    target = _target(path)
    head = {
        "format": _FORMAT,
        "status": solution.status.name,
        "message": solution.message,
        "step": solution.step,
        "n_steps": solution.n_steps,
        "n_force_evaluations": solution.n_force_evaluations,
        "wall_time": solution.wall_time,
        "about": asdict(solution.about),
    }
    arrays = {"t": solution.t, "x": solution.x, "v": solution.v}
    arrays |= {_INVARIANT + name: values for name, values in solution.invariants.items()}
    arrays |= {_DERIVED + name: values for name, values in solution.derived.items()}
    partial = target.with_name(f".{target.name}.{os.getpid()}.partial")
    try:
        with partial.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, header=np.array(json.dumps(head)), **arrays)
        partial.replace(target)
    except OSError as error:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
        raise FileFormatError(
            f"path={str(path)!r} cannot be written: {error.strerror}; choose another folder."
        ) from None
    return target


def _target(path: str | Path) -> Path:
    target = Path(path)
    if target.name in ("", "..") or "\0" in str(path):
        raise FileFormatError(f"path={str(path)!r} does not name a file; give a name such as 'run.npz'.")
    return target if target.suffix == ".npz" else target.with_name(target.name + ".npz")


def load(path: str | Path) -> Solution:
    """Read a solution that `Solution.save` wrote.

    Raises
    ------
    FileFormatError
        If there is no such file, or it is not a solution.
    """
    try:
        with Path(path).open("rb") as handle, np.load(handle, allow_pickle=False) as file:
            head = json.loads(str(file["header"]))
            arrays: dict[str, Any] = {name: file[name] for name in file.files if name != "header"}
        if head["format"] != _FORMAT:
            raise KeyError("format")
        return _assemble(head, arrays)
    except OSError as error:
        raise FileFormatError(f"path={str(path)!r} cannot be read: {error.strerror or error}.") from None
    except _FOREIGN as error:
        raise FileFormatError(
            f"path={str(path)!r} is not a kickdrift solution ({type(error).__name__}: {error});"
            " give a file that Solution.save wrote."
        ) from None


def _assemble(head: dict[str, Any], arrays: dict[str, Any]) -> Solution:
    about = {f.name: head["about"][f.name] for f in fields(Description)}
    about["dimensions"] = tuple(about["dimensions"])
    about["kind"] = Kind[about["kind"]].name
    kept = {name.removeprefix(_INVARIANT): a for name, a in arrays.items() if name.startswith(_INVARIANT)}
    derived = {name.removeprefix(_DERIVED): a for name, a in arrays.items() if name.startswith(_DERIVED)}
    t, x, v = arrays["t"], arrays["x"], arrays["v"]
    if any(array.dtype != np.float64 for array in (t, x, v, *kept.values(), *derived.values())):
        raise ValueError("its arrays are not float64")
    if any(values.shape[:1] != t.shape for values in (*kept.values(), *derived.values())):
        raise ValueError("an invariant has another number of times")
    if not (t.ndim == 1 and t.size and v.shape in (x.shape, (t.size, 0)) and x.shape[:1] == t.shape):
        raise ValueError(f"t, x and v have shapes {t.shape}, {x.shape} and {v.shape}")
    return Solution(
        t=t,
        x=x,
        v=v,
        invariants=Invariants(tuple(kept), kept.__getitem__),
        status=Outcome[head["status"]],
        message=str(head["message"]),
        step=float(head["step"]),
        n_steps=int(head["n_steps"]),
        n_force_evaluations=int(head["n_force_evaluations"]),
        wall_time=float(head["wall_time"]),
        about=Description(**about),
        derived=derived,
    )
