"""How a run can end. The value of an outcome is its sentence."""

from enum import Enum


class Outcome(Enum):
    """The ways in which a run ends; ``outcome.value`` is the sentence shown to users.

    Attributes
    ----------
    COMPLETED, STOPPED
        The end of t_span was reached, or a terminal event: both are a success.
    INTERRUPTED
        By Ctrl-C, or the stop button of a notebook.
    NOT_FINITE, FAILED
        The state became infinite or NaN; a function raised or returned NaN.
    NOT_WRITTEN
        The output could not be written, as on a full disk.
    NO_STEP, STEP_LIMIT
        No valid size was found for the next step; ``max_steps`` was reached.
    NOT_CONVERGED
        The equations of an implicit step were not solved.

    Examples
    --------
    >>> import kickdrift as kd
    >>> sol = kd.solve(kd.systems.kepler(), (0.0, 20.0), step=0.01, method="leapfrog")
    >>> sol.status
    <Outcome.COMPLETED: 'The end of t_span was reached.'>
    >>> sol.status.value
    'The end of t_span was reached.'
    """

    COMPLETED = "The end of t_span was reached."
    STOPPED = "A terminal event ended the run."
    INTERRUPTED = "Interrupted by the user; everything up to the interruption is kept."
    NOT_FINITE = "The state became infinite or not a number; the solution ends with the last good state."
    FAILED = "A function raised an error or returned NaN; the solution ends with the last good state."
    NOT_WRITTEN = "The output could not be written; the run ends there, and what was written before is intact."
    NO_STEP = "No valid size was found for the next step."
    STEP_LIMIT = "As many steps as max_steps were taken before the end of t_span; everything up to there is kept."
    NOT_CONVERGED = "The equations of an implicit step were not solved; the solution ends with the last good state."

    @property
    def success(self) -> bool:
        """Whether the run reached the end of t_span, or a terminal event."""
        return self in (Outcome.COMPLETED, Outcome.STOPPED)
