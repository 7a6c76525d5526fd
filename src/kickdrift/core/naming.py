"""Names of specialised functions, unique to the values bound into them: compiled code is stored on disk under these names."""

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

Function = Callable[..., Any]


def digest(value: Any) -> str:
    """Return a key of 32 letters for bytes, or for a value whose `repr` is the same in every process."""
    data = value if isinstance(value, bytes) else repr(value).encode()
    return hashlib.sha256(data).hexdigest()[:32]


def specialised_name(function: Function, *details: str) -> str:
    """Return a name for a specialisation of `function` that differs from all others, and changes with the sources."""
    python_function = getattr(function, "py_func", function)
    parts = (python_function.__module__, python_function.__qualname__, *details, source_digest())
    return "_".join(parts).replace(".", "_").replace("-", "_").replace("<", "").replace(">", "")


def comes_with_kickdrift(function: Function) -> bool:
    """Whether a function's source is in `source_digest`, so that its specialisations may be cached on disk."""
    return str(getattr(function, "py_func", function).__module__).startswith("kickdrift.systems.")


@cache
def source_digest(*floors: str) -> str:
    """Digest of the sources of some subpackages; by default of those other than worlds that contain compiled code."""
    package = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for floor in floors or ("core", "systems", "engine"):
        for path in sorted((package / floor).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
