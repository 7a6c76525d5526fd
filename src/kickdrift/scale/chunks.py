"""Members in chunks, each of which is a task: run in whatever process, and written there if rows go to disk."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from kickdrift.engine.lane_letters import LANES
from kickdrift.scale.member_store import MemberStore
from kickdrift.scale.members import Members
from kickdrift.scale.prepared import Prepared, Settings, prepare
from kickdrift.scale.results import Results
from kickdrift.scale.running import Runs
from kickdrift.systems.system import System

_TASKS_OF_A_WORKER = 8  # so that one that is slow, or dies, does not keep the others waiting
_BYTES = 1 << 28  # of the rows of a chunk, if they go to disk


@dataclass(frozen=True)
class Chunk:
    """A task: some members, the index of the first of them, and the first of all, which defines what they have in common.

    Attributes
    ----------
    store : MemberStore or None
        Where the rows go, if they are not returned.
    """

    first: int
    members: Members
    lead: Members
    settings: Settings
    store: MemberStore | None = None


def run_chunk(chunk: Chunk, threads: int = 1, tell: Callable[[int], None] = lambda done: None) -> Results:
    """Run the members of a chunk, in any process; the results contain no rows if these go to disk."""
    if chunk.store is not None:
        chunk.store.open()  # which fails before the work, if it does
    prepared = prepare(chunk.members, chunk.settings, False, chunk.lead)
    runs = Runs(prepared, threads, False)
    runs.go(tell)
    if chunk.store is None:
        return runs.results
    return chunk.store.put(chunk.first, prepared, runs.results)


def run_here(
    prepared: Prepared, results: Results, store: MemberStore, threads: int, tell: Callable[[int], None]
) -> None:
    """Run chunks that go to disk one after the other, each on threads; a KeyboardInterrupt keeps those that are done."""
    steps = 0

    def told(done: int) -> None:
        tell(steps + done)

    for chunk in chunks_of(prepared, store.members_of_chunk, results, store):
        part = run_chunk(chunk, threads, told)
        results.put(chunk.first, part)
        steps += int(part.n_steps.sum())


def members_of_chunk(prepared: Prepared, workers: int, to_disk: bool, least: int = 1) -> int:
    """Return the number of members of a chunk, such that each worker gets several chunks."""
    count = prepared.members.count
    size = max(-(-count // (_TASKS_OF_A_WORKER * workers)), least)
    if size > LANES // 2:
        size = -(-size // LANES) * LANES
    if to_disk:
        row = 8 * prepared.t.size * (prepared.system.x0.size + prepared.system.v0.size)
        size = max(1, min(size, _BYTES // row))
    return min(size, count)


def chunks_of(prepared: Prepared, size: int, results: Results, store: MemberStore | None = None) -> Iterator[Chunk]:
    """Divide the members that are not done into chunks."""
    members = prepared.members
    settings = replace(prepared.settings, method=prepared.chosen.method, order=None)
    lead = _sent(members.part(0, 1))
    for first in range(0, members.count, size):
        last = min(first + size, members.count)
        if not results.done[first:last].all():
            yield Chunk(first, _sent(members.part(first, last)), lead, settings, store)


def _sent(members: Members) -> Members:
    """Return a copy without the closures, which cannot be pickled and are not needed."""
    if not isinstance(members.problem, System):
        return members
    return replace(members, problem=replace(members.problem, exact=None))
