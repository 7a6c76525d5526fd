"""Members made ready: the system of the first, the method, the steps; and the systems of the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError, KickdriftError
from kickdrift.core.room import free_bytes
from kickdrift.engine import quantities
from kickdrift.engine.announcing import compiling_announced
from kickdrift.engine.controller import Controller
from kickdrift.engine.cut_members import cut_numbers
from kickdrift.engine.dense import check_between
from kickdrift.engine.event_functions import Event, check_path, events_of
from kickdrift.engine.flows.surfaces import PLACE_OF_SIDES
from kickdrift.engine.grid import Course, Grid
from kickdrift.engine.impacts import Impacts
from kickdrift.engine.method_selection import Choice, check_direction, choose
from kickdrift.engine.problem_adapter import Adapter
from kickdrift.engine.start import parameters, start_of
from kickdrift.engine.steering import Steering
from kickdrift.engine.table_ranges import tables_of
from kickdrift.methods import Method
from kickdrift.scale.members import Members
from kickdrift.scale.moments import Moments
from kickdrift.scale.results import Results
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
_LOOKED_AT = 8  # members that are described to see that they differ by their numbers alone
_PART = 0.8  # of the memory that is free


@dataclass(frozen=True)
class Settings:
    """The arguments of `kickdrift.solve` that are common to all members."""

    t_span: Sequence[float]
    method: str | Method | None
    order: int | None
    t_eval: ArrayLike | None
    save_every: int | None
    steering: Steering
    compensated: bool
    compile: bool
    check_bounds: bool
    events: tuple[Callable[..., Any], ...] = ()
    max_steps: int | None = None


@dataclass(frozen=True)
class Cohort:
    """Members of one step, or of steps that vary."""

    indices: NDArray[np.intp]
    grid: Grid | Course

    @property
    def length(self) -> int:
        """Steps of a member, for the progress; 1 where they vary."""
        return self.grid.n_steps if isinstance(self.grid, Grid) else 1


@dataclass(frozen=True)
class Prepared:
    """Members, and the common properties of their runs.

    Attributes
    ----------
    members : Members
    settings : Settings
    system : System
        Of the first member.
    chosen : Choice
        The method of all members.
    cohorts : list of Cohort
    t : (T,) array
        Times of the rows.
    controller : Controller or None
        The control of the steps of the first member, if they vary.
    driven : System
        That of the first member, with the functions of the controller.
    events : tuple of Event
        The events of the first member.
    """

    members: Members
    settings: Settings
    system: System
    chosen: Choice
    cohorts: list[Cohort]
    t: Floats
    controller: Controller | None
    driven: System
    events: tuple[Event, ...] = ()

    def room(self, to_disk: bool = False) -> Results:
        """Allocate the results of the members, without the rows if these go to disk.

        Raises
        ------
        ArgumentError
            If there is not so much memory.
        """
        count, times, system = self.members.count, 0 if to_disk else self.t.size, self.system
        _check_room(count, times, system.x0.size + system.v0.size)
        return Results.empty(count, times, system.x0.shape, system.v0.shape, len(self.events))

    def system_of(self, i: int) -> System:
        """Describe the system of a member."""
        return _described(self.members, self.settings, i, self.cohorts[0].grid.t0)

    def numbers(self) -> tuple[Floats, Floats, Floats] | None:
        """Return x, v and params of all members, (M, n) each; None where they differ by more than these, or one cannot be."""
        try:
            return self._numbers()
        except KickdriftError:  # an error of one member, which its run will report
            return None

    def _numbers(self) -> tuple[Floats, Floats, Floats] | None:
        members, system = self.members, self.system
        if members.made is not None or getattr(members.problem, "start_in_params", False):
            return self._of_each()
        x, v = (
            np.broadcast_to(
                own.reshape(1, -1) if given is None else given.reshape(len(given), -1), (members.count, own.size)
            )
            for own, given in ((system.x0, members.x0), (system.v0, members.v0))
        )
        params = np.broadcast_to(system.params, (members.count, system.params.size)).copy()
        if members.args is not None:
            params[:, : members.args.shape[1]] = members.args
        place = self._place_of_sides()
        if place >= 0:
            _, sides, _ = self.cut_numbers(np.arange(members.count), x, v)
            params[:, place : place + sides.shape[1]] = sides
        if members.seeds is not None:
            params[:, -2], params[:, -1] = members.seeds & np.uint64(0xFFFFFFFF), members.seeds >> np.uint64(32)
        for i in np.unique(
            np.linspace(0, members.count - 1, _LOOKED_AT).astype(int)
        ):  # a description may make more of them
            other = self.system_of(int(i))
            if not (np.array_equal(other.params, params[i]) and _alike(other, system)):
                return None
        return x, v, params

    def _of_each(self) -> tuple[Floats, Floats, Floats] | None:
        systems = [self.system_of(i) for i in range(self.members.count)]
        if not all(_alike(system, self.system) for system in systems):
            return None
        x, v, params = (
            np.stack([getattr(system, name).reshape(-1) for system in systems]) for name in ("x0", "v0", "params")
        )
        return x, v, params

    def with_args(self, params: Floats, indices: NDArray[np.intp]) -> Floats:
        """Return params that begin with the numbers of users, with those of each of some members."""
        args, numbers = self.members.args, np.tile(params, (indices.size, 1))
        if args is not None:
            numbers[:, : args.shape[1]] = args[indices] if len(args) > 1 else args
        return numbers

    def cut_alike(self) -> bool:
        """Whether impacts and switches of the members, if there are any, differ by starts and numbers of users alone."""
        steering, members, controller = self.settings.steering, self.members, self.controller
        if not steering.cuts:
            return True
        assert controller is not None
        if members.made is not None or (steering.impacts is not None and steering.switches is not None):
            return False
        frictionless = not isinstance(steering.impacts, Impacts) or not np.any(steering.impacts.friction)
        return frictionless or self.system.x0.ndim < 2  # or else friction is checked at each start

    def cut_numbers(self, indices: NDArray[np.intp], x: Floats, v: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Return what impacts or switches of some members are, see `kickdrift.engine.cut_members.cut_numbers`."""
        assert self.controller is not None
        assert self.controller.function is not None
        params = self.controller.function.params
        of_function = self.with_args(np.zeros(0) if params is None else params, indices)
        return cut_numbers(self.controller, self.system, self.cohorts[0].grid.t0, x, v, of_function)

    def _place_of_sides(self) -> int:
        """Return where the sides of switches are in the params, -1 where they are not."""
        controller = self.controller
        return -1 if not self.settings.steering.cuts or controller is None else int(controller.params[PLACE_OF_SIDES])

    def evaluate(self, name: str, x: Floats, v: Floats) -> Floats:
        """Evaluate a conserved quantity of all members at their rows: (M, T), or (M, T, size)."""
        count, t = self.members.count, self.t
        if self.one_system():
            values = quantities.evaluate(self.system, name, np.tile(t, count), x, v)
            return values.reshape(count, t.size, *values.shape[1:])
        return np.stack([quantities.evaluate(self.system_of(i), name, t, x[i], v[i]) for i in range(count)])

    def evaluate_last(self, name: str, last: Sequence[Moments]) -> tuple[Floats, ...]:
        """Evaluate a conserved quantity at the last rows of members, (K,), or (K, size), each."""
        sizes = [own.t[0].size for own in last]
        if self.one_system():
            rows = (np.concatenate([arrays[0] for arrays in kind]) for kind in zip(*last, strict=True))
            values = quantities.evaluate(self.system, name, *rows)
        else:
            ended = [i for i, size in enumerate(sizes) if size] or [0]
            values = np.concatenate(
                [quantities.evaluate(self.system_of(i), name, *(arrays[0] for arrays in last[i])) for i in ended]
            )
        return tuple(np.split(values, np.cumsum(sizes)[:-1]))

    def one_system(self) -> bool:
        """Whether all members have one system, started otherwise."""
        members = self.members
        return members.made is None and members.seeds is None and (members.args is None or len(members.args) == 1)


def prepare(
    members: Members, settings: Settings, progress: bool | None, lead: Members | None = None, to_disk: bool = False
) -> Prepared:
    """Describe the first member, or the first of others that `lead`, choose the method, and lay the steps.

    Raises
    ------
    ArgumentError
        For whatever `kickdrift.solve` would refuse, and more rows than fit in memory: of one member if they go `to_disk`.
    """
    lead = lead or members
    x0, v0, args = lead.start_of(0)
    start, params = start_of(lead.problem_of(0), x0, v0), parameters(args)
    steering = settings.steering
    if steering.varies and settings.t_eval is None:
        raise ArgumentError("steps vary from member to member; give t_eval=..., the times to keep for all members.")
    cohorts = []
    for indices in members.cohorts():
        numbers, step = (1 if to_disk else members.count) * start.x.size, members.step_of(int(indices[0]))
        given = settings.t_span, step, settings.t_eval, settings.save_every
        cohorts.append(Cohort(indices, steering.lay(*given, numbers, max_steps=settings.max_steps)))
    first = cohorts[0].grid
    t = _times(first)
    if any(not np.array_equal(t, _times(cohort.grid)) for cohort in cohorts):
        raise ArgumentError(
            f"step has {len(cohorts)} values, which lead to different times; give t_eval=..., the times to keep for"
            " all members."
        )
    with compiling_announced(progress):
        adapter = Adapter(first.t0, start.x, start.v, params, settings.compile, settings.check_bounds, [])
        system = steering.describe(lead.problem_of(0), start, adapter)
        span, defaults = first.t1 - first.t0, steering.defaults
        chosen = choose(settings.method, settings.order, system, first.t0, first.step, span, **defaults)
        check_direction(chosen.method, first.step)
        driven, controller = steering.ready(lead.problem_of(0), system, chosen.method, first, adapter, lead.step_of(0))
        events = events_of(settings.events or None, adapter.number)
        check_path(events, system)
        functions = lead.problem_of(0), steering.control, steering.impacts, steering.switches, settings.events
        tables = tables_of(functions, driven, chosen.method, controller, events)
    for cohort in cohorts:
        if isinstance(cohort.grid, Grid):
            check_between(system, cohort.grid)
        if tables is not None:
            tables.check(cohort.grid)
    return Prepared(members, settings, system, chosen, cohorts, t, controller, driven, events)


def _times(grid: Grid | Course) -> Floats:
    if grid.wanted is not None:
        return grid.wanted
    return grid.times if isinstance(grid, Grid) else grid.marks


def _check_room(count: int, times: int, numbers: int) -> None:
    size, most = 8.0 * count * times * numbers, _PART * free_bytes()
    if size > most:
        raise ArgumentError(
            f"{count} members at {times} times are {size / 2**30:.3g} GiB, and there is room for {most / 2**30:.3g}"
            " GiB; keep fewer times (save_every, t_eval), or give save_to='run.zarr', a folder for them."
        )


def _described(members: Members, settings: Settings, i: int, t0: float) -> System:
    x0, v0, args = members.start_of(i)
    problem = members.problem_of(i)
    start = start_of(problem, x0, v0)
    adapter = Adapter(t0, start.x, start.v, parameters(args), settings.compile, settings.check_bounds, [])
    return settings.steering.describe(problem, start, adapter)


def _alike(one: System, other: System) -> bool:
    """Whether systems have the same functions, so that they differ by numbers alone."""
    same = one.acceleration is other.acceleration and one.velocity is other.velocity and one.kind is other.kind
    shapes = one.x0.shape == other.x0.shape and one.params.shape == other.params.shape
    return same and shapes and dict(one.parts) == dict(other.parts)
