"""Memory of large temporary arrays stays with the process."""

import os
import platform
import subprocess
import sys

import pytest

CODE = """
import resource, sys
import numpy as np
from kickdrift.core.heap import keep_freed_memory

if sys.argv[1] == "kept":
    keep_freed_memory()
for count in (10, 100):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(count):
        arrays = [np.ones(50_000) for _ in range(4)]
        del arrays
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def page_faults(how, **variables):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")} | variables
    command = [sys.executable, "-c", CODE, how]
    return int(subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library")
def test_arrays_of_each_step_do_not_wait_for_new_pages():
    assert page_faults("given back") > 10_000  # 390 pages in each of 100 rounds
    assert page_faults("kept") < 1_000
    assert page_faults("kept", MALLOC_TRIM_THRESHOLD_="131072") > 10_000  # the environment has said otherwise
