"""Ensembles: many Kepler orbits, and many outer solar systems, against diffrax and heyoka."""

from benchmarks.ensemble import orbits_to_errors, planets, steps
from benchmarks.table import Row


def compare(rounds: int) -> list[Row]:
    """Compare the time of a step of a member, and those of runs to an error."""
    return steps.compare(rounds) + orbits_to_errors.compare() + planets.compare()
