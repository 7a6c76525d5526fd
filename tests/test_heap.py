"""Memory of large temporary arrays stays with the process."""

import os
import platform
import subprocess
import sys

import pytest

from kickdrift.core import heap

CODE = """
import resource, runpy, sys
import numpy as np
keep_freed_memory = runpy.run_path(sys.argv[1])["keep_freed_memory"]  # without the package, which takes long to import

for keep in (lambda: None, keep_freed_memory):
    keep()
    for count in (10, 100):
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
        for _ in range(count):
            arrays = [np.ones(50_000) for _ in range(4)]
            del arrays
    print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def page_faults(**variables):
    """Page faults of a hundred rounds, before and after memory that is freed is to be kept."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")} | variables
    command = [sys.executable, "-c", CODE, heap.__file__]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    return [int(line) for line in done.stdout.split()]


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library")
def test_arrays_of_each_step_do_not_wait_for_new_pages():
    given_back, kept = page_faults()
    assert given_back > 10_000  # 390 pages in each of 100 rounds
    assert kept < 1_000
    assert min(page_faults(MALLOC_TRIM_THRESHOLD_="131072")) > 10_000  # the environment has said otherwise
