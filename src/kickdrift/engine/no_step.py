"""Sentences on why there is no next step, by the residual that says so."""

from kickdrift.engine.flows.layout import (
    CHATTERING,
    CROWDED,
    FAILED_CONTROL,
    JAMMED,
    LOST_TO_ROUNDING,
    MISSED_DENSITY,
    MISSED_SWITCH,
    NOT_HELD,
    UNFIT_DENSITY,
    UNSIGNED_GAP,
)

NO_STEP = {
    FAILED_CONTROL: " The step control returned NaN, or the motion was lost.",
    UNFIT_DENSITY: (
        " The step density, or -U or T - E of the logarithmic Hamiltonian, is zero, negative or not a number there. Give a"
        " density that stays positive, or try a smaller step."
    ),
    MISSED_DENSITY: (
        " The step density changes too much there for steps of this size, or nears zero. Try a smaller step, or a density"
        " that stays away from zero."
    ),
    LOST_TO_ROUNDING: (
        " The steps have become shorter than the spacing of numbers at t: the motion goes to infinity there, bodies collide,"
        " or a function jumps or is not a number."
    ),
    JAMMED: (
        " No time passes between impacts: bodies are jammed without clearance, or a gap closes where its gradient is"
        " zero. Leave some clearance, or use a lower restitution."
    ),
    CHATTERING: (
        " There the force on both sides of a switch leads back to it, and the motion slides along it, as in dry friction"
        " at rest. That needs a force linear in the side, which is then a number between -1 and 1: write"
        " -0.2 * params[-1], and not -0.2 if params[-1] > 0 else 0.2."
    ),
    MISSED_SWITCH: (
        " The motion slides along switches, but no sides were found with which the step ends at them: their effects are"
        " nearly the same, or change too much within the step. Try a smaller step."
    ),
    NOT_HELD: (
        " A resting body cannot be kept on all its surfaces: they leave no room, or curve too much within a step."
        " Leave some clearance, or try a smaller step."
    ),
    CROWDED: (
        " More gaps are closed at once than twice the numbers of the state, so most are redundant; give one gap per"
        " surface."
    ),
    UNSIGNED_GAP: (
        " A gap has reached zero and grown again without becoming negative, so that its sides cannot be told apart;"
        " give a function that is negative where bodies overlap, such as x instead of abs(x) or x**2."
    ),
}
