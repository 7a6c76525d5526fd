"""The command line, ``kickdrift``. Nothing here imports what only some commands need."""

import sys

from kickdrift.core.errors import missing_extra

DONE, BAD_INPUT, FAILED, INTERRUPTED = 0, 2, 3, 130  # exit codes


def main() -> int:
    """Run the command line on the arguments of the process.

    Returns
    -------
    int
        The exit code: 0 done, 2 input that cannot be used, 3 a run that failed on its way, 130 interrupted.
    """
    try:
        import typer  # noqa: F401
    except ImportError:
        print(f"kickdrift: {missing_extra('the command line', 'typer', 'cli')}", file=sys.stderr)
        return BAD_INPUT
    from kickdrift.cli.app import app

    app(prog_name="kickdrift")
    return DONE
