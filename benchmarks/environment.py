"""The environment of processes that are timed from their start."""

import os


def environment(**more: str) -> dict[str, str]:
    """Return this process's environment, with bytecode kept beside the sources, as after an installation."""
    return {**os.environ, "PYTHONDONTWRITEBYTECODE": "", **more}
