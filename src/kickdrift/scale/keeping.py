"""Checkpoints of ensembles: the finished members; the same call continues with the others."""

import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from kickdrift.core.errors import FileFormatError
from kickdrift.core.naming import digest
from kickdrift.core.outcomes import Outcome
from kickdrift.engine.checkpoints import Checkpoints
from kickdrift.engine.identity import marked, written
from kickdrift.scale.moments import flattened, separated
from kickdrift.scale.prepared import Prepared
from kickdrift.scale.results import Results

_SECONDS = 60.0  # between checkpoints, if the number of members is not given
_ARRAYS = ("x", "v", "rows", "step", "step_range", "n_steps", "rejected", "evaluations")


class Kept:
    """The checkpoints of an ensemble, the last two.

    Parameters
    ----------
    folder : path
    every : int, optional
        Members from one to the next; as many as take a minute by default.
    prepared : Prepared
    results : Results
        Those of members that a checkpoint holds are filled in.
    """

    def __init__(self, folder: Any, every: int | None, prepared: Prepared, results: Results) -> None:
        self._checkpoints = Checkpoints(folder, every, 2, identity_of(prepared))
        self._every, self._results = every, results
        try:
            found = self._checkpoints.find()
            if found is not None:
                self._restore(found.header, found.arrays)
        except BaseException:
            self.close()
            raise
        self._count, self._written = int(results.done.sum()), time.perf_counter()

    def close(self) -> None:
        """Release the folder to other runs."""
        self._checkpoints.close()

    def look(self) -> None:
        """Write a checkpoint if one is due."""
        if self._every is None:
            due = time.perf_counter() - self._written > _SECONDS
        else:
            due = int(self._results.done.sum()) - self._count >= self._every
        if due:
            self.write()

    def write(self) -> None:
        """Write a checkpoint of the members that are done.

        Raises
        ------
        FileFormatError
            If it cannot be written; those before it are as they were.
        """
        results, done = self._results, np.flatnonzero(self._results.done)
        outcomes = [(results.status[i].name, results.messages[i]) for i in done]
        kinds = list(dict.fromkeys(outcomes))
        places = {outcome: k for k, outcome in enumerate(kinds)}
        arrays = {name: getattr(results, name)[done] for name in _ARRAYS}
        arrays |= flattened([results.zeros[i] for i in done], "events")
        arrays |= flattened([results.last[i] for i in done], "last")
        arrays |= {"members": done, "outcome": np.array([places[each] for each in outcomes], dtype=np.int64)}
        self._checkpoints.write(done.size, {"outcomes": kinds}, arrays)
        self._count, self._written = done.size, time.perf_counter()

    def _restore(self, header: Mapping[str, Any], arrays: Mapping[str, Any]) -> None:
        results, members = self._results, arrays["members"]
        try:
            for name in _ARRAYS:
                getattr(results, name)[members] = arrays[name]
            zeros, last = (separated(arrays, members.size, name) for name in ("events", "last"))
            for k, i in enumerate(members):
                results.zeros[i], results.last[i] = zeros[k], last[k]
            kinds = [(Outcome[name], str(message)) for name, message in header["outcomes"]]
            for i, kind in zip(members, arrays["outcome"], strict=True):
                results.status[i], results.messages[i] = kinds[kind]
        except (LookupError, TypeError, ValueError) as error:
            raise FileFormatError(
                f"checkpoint={str(self._checkpoints.folder)!r} has invalid contents ({type(error).__name__}: {error});"
                " remove it to start again."
            ) from None
        results.done[members] = True


def identity_of(prepared: Prepared) -> dict[str, str]:
    """Return the identity of an ensemble, by the names of the arguments of `solve_ensemble`."""
    members, settings, method = prepared.members, prepared.settings, prepared.chosen.method
    return {
        "problem": digest(written(members.problem)),
        "x0": digest(written(members.x0)),
        "v0": digest(written(members.v0)),
        "args": digest(written([members.args, members.made])),
        "step": digest(written(members.steps)),
        "seeds": digest(written(members.seeds)),
        "t_span": repr([float(t) for t in settings.t_span]),
        "method": f"{method.name} {digest(written(method))}",
        "compensated": repr(settings.compensated),
        "compile": repr(settings.compile),
        "step_control, impacts or switches": digest(written(settings.steering)),
        "save_every or t_eval": digest(written(prepared.t)),
        "events": digest(written(marked(settings.events))),
        "max_steps": repr(settings.max_steps),
    }
