"""The members of an ensemble: the initial state, parameters, step or seed of each."""

from __future__ import annotations

import inspect
import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import reals
from kickdrift.core.errors import ArgumentError, KickdriftError, unknown_name
from kickdrift.core.units import has_unit
from kickdrift.systems.problem import Problem, name_of
from kickdrift.systems.system import System

Floats = NDArray[np.float64]
_OF_FUNCTIONS = {"x", "params", "out"}  # one of which every function of params names
_OURS = ("args", "step", "seed", "member", "time", "status")


@dataclass(frozen=True)
class Members:
    """The members of an ensemble: arrays with one value for each member, or one for all.

    Attributes
    ----------
    problem : System, Problem or callable
        Or a function that creates one from `made`.
    count : int
    steps : array or None
    x0, v0 : array or None
        None where systems bring their own.
    args : array or None
    seeds : array or None
    made : sequence of dict, optional
        The arguments from which `problem` makes the system of each member.
    parameters : mapping of str to array
        Parameters that distinguish the members, for display: (M,) or (M, p).
    """

    problem: Any
    count: int
    steps: Floats | None
    x0: Floats | None = None
    v0: Floats | None = None
    args: Floats | None = None
    seeds: NDArray[np.uint64] | None = None
    made: Sequence[Mapping[str, Any]] | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict)

    def problem_of(self, i: int) -> Any:
        """Return the problem of a member."""
        problem = self.problem if self.made is None else _made(self.problem, self.made[i])
        return problem if self.seeds is None else replace(problem, seed=int(_of(self.seeds, i)))

    def start_of(self, i: int) -> tuple[Any, Any, Any]:
        """Return x0, v0 and args of a member."""
        return tuple(None if array is None else _of(array, i) for array in (self.x0, self.v0, self.args))  # type: ignore[return-value]

    def step_of(self, i: int) -> float | None:
        """Return the largest step of a member, or the first one; None if there is none given."""
        return None if self.steps is None else float(_of(self.steps, i))

    def cohorts(self) -> list[NDArray[np.intp]]:
        """Return the members of each step."""
        if self.steps is None:
            return [np.arange(self.count)]
        steps = np.broadcast_to(self.steps, self.count)
        return [np.flatnonzero(steps == step) for step in np.unique(steps)]

    def part(self, first: int, last: int) -> Members:
        """Return the members from `first` to `last`."""

        def cut(array: Any) -> Any:
            return array if array is None or len(array) == 1 else array[first:last]

        arrays = {name: cut(getattr(self, name)) for name in ("steps", "x0", "v0", "args", "seeds")}
        made = None if self.made is None else self.made[first:last]
        return Members(self.problem, last - first, made=made, **arrays)


def _of(array: Any, i: int) -> Any:
    return array[i if len(array) > 1 else 0]


def members_of(
    problem: Any,
    x0: ArrayLike | None,
    v0: ArrayLike | None,
    args: Any,
    step: ArrayLike | None,
    seeds: Sequence[int] | None,
) -> Members:
    """Return the members that the arguments describe, see `kickdrift.solve_ensemble`.

    Raises
    ------
    ArgumentError
        For inconsistent numbers of members, or invalid values of a member.
    """
    made, numbers = None, None
    parameters: dict[str, Any] = {}
    if isinstance(args, Mapping):
        made, parameters, numbers = _swept(problem, args)
    elif args is not None:
        numbers = _numbers("args", args)
        if numbers.ndim > 2:
            raise ArgumentError(f"args has shape {numbers.shape}; give (M, p), or p numbers for all members.")
        if numbers.ndim == 2:
            parameters = {"args": numbers}
        numbers = numbers.reshape(-1, numbers.shape[-1] if numbers.ndim else 1)
    shape = _shape_of_states(problem if made is None else _made(problem, made[0]))
    x, v = _starts(shape, x0, v0)
    steps = None if step is None else _numbers("step", step)
    given_seeds = _seeds(problem, seeds)
    if steps is not None and steps.ndim > 1:
        raise ArgumentError(f"step has shape {steps.shape}; give a number, or one per member.")
    if steps is not None and steps.ndim:
        parameters = {**parameters, "step": steps}
    if given_seeds is not None:
        parameters = {**parameters, "seed": given_seeds}
    steps = None if steps is None else np.atleast_1d(steps)
    count = _count({"x0": x, "v0": v, "args": made or numbers, "step": steps, "seeds": given_seeds})
    return Members(problem, count, steps, x, v, numbers, given_seeds, made, parameters)


def _numbers(name: str, value: Any) -> Floats:
    try:
        numbers = reals(value)
    except TypeError as error:
        raise ArgumentError(f"{name}={value!r} is not an array of numbers: {error}.") from None
    if not numbers.size:
        raise ArgumentError(f"{name} of shape {numbers.shape} is empty; an ensemble has at least one member.")
    if not np.isfinite(numbers).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(numbers))[0])
        raise ArgumentError(f"{name} is {numbers[where]} at index {where}; it must be finite for every member.")
    return numbers


def _count(given: Mapping[str, Any]) -> int:
    """Return the number of members: each argument has one value per member, or one for all."""
    counts = {name: len(values) for name, values in given.items() if values is not None}
    count = max(counts.values())
    if any(own not in (1, count) for own in counts.values()):
        told = ", ".join(f"{name} {own}" for name, own in counts.items() if own != 1)
        raise ArgumentError(
            f"the numbers of members differ: {told}; give the same number everywhere, or one for all members."
        )
    return count


def _starts(shape: tuple[int, ...] | None, x0: ArrayLike | None, v0: ArrayLike | None) -> tuple[Any, Any]:
    """Return starts with members along the first axis."""
    x, v = (None if value is None else _numbers(name, value) for name, value in (("x0", x0), ("v0", v0)))
    if shape is not None:  # of the states of a system: a single one of its shape applies to all members
        return tuple(None if array is None else array[None] if array.shape == shape else array for array in (x, v))  # type: ignore[return-value]
    if x is None:
        raise ArgumentError("x0 is missing; a function needs x0 and v0 to start from, members along the first axis.")
    if v is None:
        return np.atleast_1d(x), None
    try:
        x, v = np.broadcast_arrays(np.atleast_1d(x), v)
    except ValueError:
        raise ArgumentError(
            f"x0 has shape {x.shape} but v0 has shape {v.shape}; members are along the first axis, and both must have"
            " the same shape."
        ) from None
    return np.ascontiguousarray(x), np.ascontiguousarray(v)


def _shape_of_states(problem: Any) -> tuple[int, ...] | None:
    return problem.x0.shape if isinstance(problem, System) else None


def _seeds(problem: Any, seeds: Sequence[int] | None) -> NDArray[np.uint64] | None:
    if seeds is None:
        return None
    if not is_dataclass(problem) or "seed" not in {f.name for f in fields(problem)}:
        raise ArgumentError(
            "seeds are given, but the problem is not stochastic; kd.Langevin describes one with a seed."
        )
    try:
        whole = [int(seed) for seed in seeds if not isinstance(seed, bool | float)]
        return np.array(whole, dtype=np.uint64).reshape(len(seeds))
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"seeds={seeds!r} must be integers from 0 to 2**64 - 1, one per member.") from None


def _swept(
    problem: Any, ranges: Mapping[str, Any]
) -> tuple[list[dict[str, Any]] | None, dict[str, Any], Floats | None]:
    """Return the product of named ranges: arguments of a function that makes systems, labels, and params of functions."""
    for name in ranges:
        if not isinstance(name, str) or name in _OURS:
            raise ArgumentError(f"args has the name {name!r}, which is already in use; give another.")
    if not ranges:
        raise ArgumentError("args={} has no names; give ranges by the names of the parameters, or leave it out.")
    allowed = _arguments_of_maker(problem)
    if allowed is not None and (unknown := [name for name in ranges if name not in allowed]):
        raise unknown_name("args", unknown[0], allowed)
    if with_units := [name for name, values in ranges.items() if has_unit(values)]:
        raise ArgumentError(f"args[{with_units[0]!r}] has a unit, which would be lost; give plain numbers.")
    axes = {name: list(values) if np.ndim(values) else [values] for name, values in ranges.items()}
    if empty := [name for name, values in axes.items() if not values]:
        raise ArgumentError(f"args[{empty[0]!r}] is empty; give at least one number.")
    product = list(itertools.product(*axes.values()))
    columns = {name: [member[k] for member in product] for k, name in enumerate(axes) if np.ndim(ranges[name])}
    labels = {name: np.array(values) for name, values in columns.items()}
    if allowed is not None:
        return [dict(zip(axes, member, strict=True)) for member in product], labels, None
    return None, labels, _numbers("args", product)


def _arguments_of_maker(problem: Any) -> list[str] | None:
    """Return the names of the arguments of a function that makes systems; None for a problem, or the function of one."""
    if isinstance(problem, System | Problem) or not callable(problem):
        return None
    try:
        names = list(inspect.signature(problem).parameters)
    except (TypeError, ValueError):
        return None
    return names if _OF_FUNCTIONS.isdisjoint(names) else None


def _made(maker: Callable[..., Any], arguments: Mapping[str, Any]) -> Any:
    try:
        made = maker(**arguments)
    except KickdriftError:
        raise
    except Exception as error:
        given = ", ".join(f"{name}={value!r}" for name, value in arguments.items())
        raise ArgumentError(
            f"problem={name_of(maker)} raised {type(error).__name__} for {given}: {error}; give other args, or correct the"
            " function."
        ) from error
    if not isinstance(made, System | Problem):
        raise ArgumentError(
            f"problem={maker!r} returned {made!r}; a function with these argument names must return a system, or be an"
            " acceleration with arguments x, t, v, params and out."
        )
    return made
