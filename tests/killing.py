"""What stands for a kill in tests: an error that nobody catches, raised in place of a call."""

from contextlib import contextmanager

import pytest


class KilledError(BaseException):
    """Ends a run where it stands, as a kill does."""


@contextmanager
def killed_after(count, of, name, monkeypatch):
    """Let a method of a class be called so often, and die in place of the next call."""
    original, called = getattr(of, name), []

    def counted(self, *arguments):
        if len(called) == count:
            raise KilledError
        called.append(1)
        original(self, *arguments)

    with monkeypatch.context() as patch:
        patch.setattr(of, name, counted)
        with pytest.raises(KilledError):
            yield
