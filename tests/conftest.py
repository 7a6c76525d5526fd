"""What holds for all tests.

Properties are tried on the same examples in every run; ``--hypothesis-profile=random`` draws new ones. Ctrl-C interrupts as on
a terminal, also where the tests were started with it ignored, as by ``nohup`` and in the background of a script.
"""

import gc
import os
import signal
import sys
from pathlib import Path

# Where no bytecode may lie beside the sources, each worker of pytest and each process that a test starts would compile all of
# them again, and rewrite the assertions of all tests: 20 s of a worker.
if sys.dont_write_bytecode and sys.pycache_prefix is None:
    sys.pycache_prefix = str(Path(__file__).parents[1] / ".pytest_cache" / "bytecode")
    sys.dont_write_bytecode = False
    os.environ["PYTHONPYCACHEPREFIX"] = sys.pycache_prefix
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# Before NumPy is imported: each core has its worker of pytest, beside which threads of OpenBLAS only wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import settings

from kickdrift.core.parallel_compile import compile_together, missing
from kickdrift.world.step.compiling import all_jobs

settings.register_profile("fixed", derandomize=True)
settings.register_profile("random", derandomize=False)
settings.load_profile("fixed")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile what most tests need, in as many processes as there are cores, before all of them would."""
    config = session.config
    if config.args_source is pytest.Config.ArgsSource.TESTPATHS and not hasattr(config, "workerinput"):
        compile_together(missing(all_jobs()))


def pytest_collection_finish() -> None:
    """Leave thousands of tests, and all that was imported, out of each collection of garbage."""
    gc.freeze()


@pytest.fixture
def small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures and films of worlds with fewer pixels than they have: for tests that look at something else."""
    monkeypatch.setattr("kickdrift.plots.animation._PIXELS", 20_000)
    monkeypatch.setattr("kickdrift.plots.world._PIXELS", 20_000)


@pytest.fixture(autouse=True, scope="session")
def _ctrl_c() -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
