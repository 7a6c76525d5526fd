"""Hostile inputs in short: the fuzzers of this folder, each on a few cases; by command they try thousands."""

import pytest
from hostile import tried

SHORT = {
    "fuzz_checkpoints": 40,
    "fuzz_world_files": 15,
    "fuzz_interruptions": 60,
    "fuzz_arguments": 600,
    "fuzz_cache": 2,
    "fuzz_operations": 20,
    "fuzz_kills": 2,
}


@pytest.mark.parametrize("fuzzer", SHORT)
def test_nothing_crashes_hangs_or_says_what_is_no_sentence(fuzzer):
    assert tried(fuzzer, range(SHORT[fuzzer])) == {}


def test_the_fuzzers_see_what_they_are_to_find():
    found = tried("hostile_cases", range(5), patience=2.0)
    assert found.keys() == {1, 2, 3, 4}
    assert found[1] == "the process died with -11"
    assert found[2] == "hangs for 2 s"
    assert found[3].startswith("raw ZeroDivisionError: division by zero (hostile_cases.py")
    assert found[4] == "failed in words"
