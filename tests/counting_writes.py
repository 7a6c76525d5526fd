"""Counts what processes write to Zarr groups, and kills one of them at a place of one's choice."""

import os
from collections import Counter
from pathlib import Path


def count_writes(log, deadly=None):
    """Note in a file each key that this process has written; die, once, instead of writing the key that is `deadly`."""
    from zarr.storage import LocalStore

    original = LocalStore.set

    async def noted(self, key, value):
        if deadly is not None and key == deadly and not os.path.exists(f"{log}.died"):
            Path(f"{log}.died").touch()
            os._exit(1)
        await original(self, key, value)
        with open(log, "a") as file:
            file.write(f"{key}\n")

    LocalStore.set = noted


class Counting:
    """The same for workers of Dask, also those that are started later: a plugin of them."""

    name = "counting"

    def __init__(self, log, deadly=None):
        self.log, self.deadly = log, deadly

    def setup(self, worker):
        count_writes(self.log, self.deadly)

    def teardown(self, worker):
        pass


def chunks_written(log):
    """Return how often each chunk was written."""
    keys = Path(log).read_text().split() if os.path.exists(log) else []
    return Counter(key for key in keys if "/c/" in key)


def chunks_there(path):
    """Return the keys of all chunks of a group."""
    return {str(file.relative_to(path)) for file in Path(path).rglob("*") if file.is_file() and "/c/" in str(file)}
