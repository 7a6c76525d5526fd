"""What a newcomer waits for: the statements of the README, one after another, in a fresh process with empty caches."""

import ast
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from contextlib import redirect_stdout
from pathlib import Path

import numpy as np

from benchmarks.environment import environment
from benchmarks.table import Row, at_most, measured

_README = Path(__file__).parent.parent / "README.md"
_SHOWN, _MOST = 1.0, 3.0  # s
Statement = tuple[int, str, float, float]  # line of the README, first line of the code, seconds, CPU seconds


def compare(rounds: int) -> list[Row]:
    """Seconds of each statement above one second, the first time on a machine: after `kickdrift compile`, and without.

    The processor's seconds, of all threads and processes, stand beside those of the clock: where they are much fewer, the
    machine was busy with something else.
    """
    return [*_rows("after kickdrift compile", compiled=True), *_rows("nothing compiled ahead", compiled=False)]


def _rows(title: str, compiled: bool) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        caches = {"NUMBA_CACHE_DIR": f"{folder}/numba", "MPLCONFIGDIR": f"{folder}/matplotlib"}
        own = environment(**caches, PYTHONPATH=os.pathsep.join(sys.path))
        rows = []
        if compiled:
            started = time.perf_counter()
            subprocess.run([sys.executable, "-m", "kickdrift", "compile"], check=True, capture_output=True, env=own)
            rows.append(measured("kickdrift compile", [time.perf_counter() - started], unit="s"))
        command = [sys.executable, "-P", __file__, str(_README)]  # -P: not beside benchmarks/c, events, world, ...
        ran = subprocess.run(command, check=True, capture_output=True, text=True, env=own, cwd=folder)
    statements: list[Statement] = [tuple(statement) for statement in json.loads(ran.stdout)]
    long = [statement for statement in statements if statement[2] > _SHOWN]
    rows += [
        measured(f"line {line}: `{code}`", [wall], at_most(_MOST, "s"), f"{cpu:.2f} s of the processor")
        for line, code, wall, cpu in long
    ]
    beyond = sum(wall > _MOST for _, _, wall, _ in statements)
    sums = np.sum([statement[2:] for statement in statements], axis=0)
    note = f"of {len(statements)}; {sums[0]:.0f} s in all, {sums[1]:.0f} s of the processor"
    rows.append(measured(f"statements above {_MOST:.0f} s", [beyond], at_most(0, "statements"), note))
    return [Row(f"{title}: {row.what}", row.wanted, row.measured, row.spread, row.verdict, row.note) for row in rows]


def statements_of(text: str) -> list[tuple[int, ast.stmt, str]]:
    """Return the Python statements of a page of Markdown: the line of each, its tree, and its first line."""
    found = []
    for block in re.finditer(r"```python\n(.*?)```", text, flags=re.DOTALL):
        above, lines = text[: block.start(1)].count("\n"), block[1].splitlines()
        found += [(above + node.lineno, node, lines[node.lineno - 1]) for node in ast.parse(block[1]).body]
    return found


def _processor() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def run(text: str) -> list[Statement]:
    """Execute the statements of a page of Markdown, and say what each took."""
    scope: dict[str, object] = {"__name__": "readme"}
    taken: list[Statement] = []
    with redirect_stdout(sys.stderr):
        for line, node, first in statements_of(text):
            code = compile(ast.Module([node], []), "README.md", "exec")
            wall, cpu = time.perf_counter(), _processor()
            exec(code, scope)
            taken.append((line, first, time.perf_counter() - wall, _processor() - cpu))
    return taken


if __name__ == "__main__":
    print(json.dumps(run(Path(sys.argv[1]).read_text(encoding="utf-8"))))
