"""``kickdrift run``: one system by one method, kept, reported and drawn."""

from pathlib import Path

from kickdrift.cli.output import exit_code, prepare_folder, say, show_table
from kickdrift.cli.plan import Plan
from kickdrift.core.errors import ArgumentError
from kickdrift.engine.solution import Solution
from kickdrift.engine.solve import solve
from kickdrift.scenes import NEWTONIAN_FLOOR, distances_to_jpl, jpl_days, kept_every, kept_times
from kickdrift.systems import ephemeris


def run(plan: Plan, folder: Path, quiet: bool, checkpoint: Path | None = None, save_to: Path | None = None) -> int:
    """Do a run, write ``<system>.npz`` and ``<system>.png`` into a folder, and return the exit code.

    A run that ends early is still written and reported. One with a folder for checkpoints resumes from the last, and one
    whose rows go to disk writes nothing else.
    """
    if save_to is not None:
        return _run_to_disk(plan, quiet, checkpoint, save_to)
    times, missed = kept_times(plan.duration, plan.step, plan.save_every, jpl_days() if plan.jpl else ())
    prepare_folder(folder)
    if not quiet:
        say(f"{plan.in_words} by {plan.taken}")
        _say_missed(missed, plan)
    solution = solve(
        plan.system,
        (0.0, plan.duration),
        step=plan.step,
        method=plan.method,
        t_eval=times,
        progress=False if quiet else None,
        checkpoint=checkpoint,
    )
    try:
        kept = solution.save(folder / f"{plan.system.name}.npz")
    finally:
        if not quiet:
            _show(solution, plan)
    picture = folder / f"{plan.system.name}.png"
    solution.plot(picture)
    if not quiet:
        print(f"\nwritten: {kept}, {picture}")
    return exit_code(solution.status, solution.message)


def _run_to_disk(plan: Plan, quiet: bool, checkpoint: Path | None, save_to: Path) -> int:
    if not quiet:
        say(f"{plan.in_words} by {plan.taken}")
    solution = solve(
        plan.system,
        (0.0, plan.duration),
        step=plan.step,
        method=plan.method,
        save_every=kept_every(plan.duration, plan.step, plan.save_every),
        progress=False if quiet else None,
        save_to=save_to,
        checkpoint=checkpoint,
    )
    if not quiet:
        print(f"{solution.report()}\n\nwritten: {save_to}")
    return exit_code(solution.status, solution.message)


def _say_missed(missed: list[float], plan: Plan) -> None:
    if missed:
        days = ", ".join(f"{day:g}" for day in missed)
        say(
            f"JPL's epochs {days} (days after J2000) fall between steps; with a whole number of --years and --step '0.25 day'"
            " or half of it, none does."
        )


def _show(solution: Solution, plan: Plan) -> None:
    print(solution.report())
    if plan.jpl:
        print()
        _show_distances(solution)


def _show_distances(solution: Solution) -> None:
    try:
        bodies, days, km = distances_to_jpl(solution)
    except ArgumentError as error:
        say(f"no comparison with JPL: {error}")
        return
    if not bodies:
        return
    print("difference from JPL's heliocentric positions (DE421), in km, by days after J2000")
    rows = [
        [body, *(f"{distance:.3g}" if distance < 1e3 else f"{distance:.0f}" for distance in row)]
        for body, row in zip(bodies, km, strict=True)
    ]
    show_table(["body", *(f"{day:g}" for day in days)], rows)
    missing = [body for body in ephemeris().bodies if body not in ("Sun", *bodies)]
    if missing:
        print(f"The attraction of {', '.join(missing)} is neglected, and so are general relativity and the asteroids.")
        return
    print(
        "The remaining difference is due to general relativity and the asteroids. For Newtonian point masses, integrated"
        " without error, it is"
    )
    for day, floor in NEWTONIAN_FLOOR.items():
        print(f"  after {day:g} days {', '.join(f'{body} {km:g}' for body, km in floor.items())} km")
