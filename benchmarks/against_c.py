"""The Benchmarks Game, against C."""

from functools import partial

import kickdrift as kd
from benchmarks import c_programs
from benchmarks.table import Row, at_most, equal, measured
from benchmarks.turns import cheapest, in_turns, nanoseconds, ratio

STEP = 0.01
STEPS = 5_000_000
ENERGIES = {1000: "-0.169087605", STEPS: "-0.169083134"}
KICKDRIFT = {"kickdrift plain": False, "kickdrift compensated": True}


def solve(steps: int, compensated: bool) -> kd.Solution:
    """Run the five bodies for so many steps of 0.01, keeping the start and the end."""
    system = kd.systems.benchmarks_game()
    span = (0.0, steps * STEP)
    return kd.solve(system, span, step=STEP, save_every=steps, compensated=compensated, progress=False)


def _ns_per_step(compensated: bool) -> float:
    return solve(STEPS, compensated).wall_time * 1e9 / STEPS


def compare(rounds: int) -> list[Row]:
    """Compare energies with what they have to be, and the time of a step with that of the fastest C build."""
    rows = [
        equal(f"energy after {steps} steps, {name}", wanted, f"{solve(steps, compensated).energy[-1]:.9f}")
        for steps, wanted in ENERGIES.items()
        for name, compensated in KICKDRIFT.items()
    ]
    builds = c_programs.build("benchmarks_game")
    contestants = {name: partial(c_programs.ns_per_step, path, STEPS) for name, path in builds.items()}
    contestants["C again"] = contestants["C"]
    contestants |= {name: partial(_ns_per_step, compensated) for name, compensated in KICKDRIFT.items()}
    costs = in_turns(contestants, rounds)
    fastest = cheapest(costs, builds)
    found = {f"{c_programs.run(path, STEPS).results[-1]:.9f}" for path in builds.values()}
    rows.append(equal("energy of all C builds", ENERGIES[STEPS], " ".join(sorted(found))))
    for name, limit in zip(KICKDRIFT, (1.2, 1.6), strict=True):
        note = nanoseconds(costs, name, fastest)
        rows.append(measured(f"{name} / {fastest}", ratio(costs, name, fastest), at_most(limit), note))
    rows.extend(measured(f"{name} / {fastest}", ratio(costs, name, fastest)) for name in builds if name != fastest)
    rows.append(measured("C / C again", ratio(costs, "C", "C again"), note="the noise of this run"))
    return rows
