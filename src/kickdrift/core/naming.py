"""Names of specialised functions, which tell apart what is bound into them: compiled code is kept on disk under them."""

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

Function = Callable[..., Any]


def digest(value: Any) -> str:
    """Return 32 letters that tell a value apart: bytes, or what is written alike in every process."""
    data = value if isinstance(value, bytes) else repr(value).encode()
    return hashlib.sha256(data).hexdigest()[:32]


def specialised_name(function: Function, *details: str) -> str:
    """Name a specialisation for `function` so that no other one, and none of changed sources, is taken for it."""
    python_function = getattr(function, "py_func", function)
    parts = (python_function.__module__, python_function.__qualname__, *details, source_digest())
    return "_".join(parts).replace(".", "_").replace("-", "_").replace("<", "").replace(">", "")


def comes_with_kickdrift(function: Function) -> bool:
    """Whether a function's source is in `source_digest`, so that its specialisations may be cached on disk."""
    return str(getattr(function, "py_func", function).__module__).startswith("kickdrift.systems.")


@cache
def source_digest(*floors: str) -> str:
    """Digest of the sources of some floors; if none are named, of those that hold compiled code beside worlds."""
    package = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for floor in floors or ("core", "systems", "engine"):
        for path in sorted((package / floor).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
