"""The table of flows that choose the size of steps, or cut them."""

from kickdrift.core.compilation import Function
from kickdrift.engine.flows import (
    between,
    cuts,
    error_control,
    impact,
    lifting,
    passing,
    resting,
    sides,
    sliding,
    sliding_mode,
    step_density,
    surfaces,
    time_transformation,
)
from kickdrift.engine.flows.record import Flow

_DENSITY: dict[str, Function] = {
    "density_of": step_density.evaluate_density,
    "rates_of_v": step_density.rates_left_out,
    "rate_of_density": step_density.difference_density,
}
_DENSITY_OF_V: dict[str, Function] = {**_DENSITY, "rates_of_v": step_density.rates_evaluated}
_ENERGY: dict[str, Function] = {
    "energy_of": time_transformation.evaluate_energy,
    "potential_of": time_transformation.evaluate_potential,
}
_SURFACES: dict[str, Function] = {
    "find_gaps": surfaces.evaluate_gaps,
    "time_slopes": surfaces.difference_in_time,
    "find_gradients": surfaces.difference_gradients,
    "reach": resting.reach_surfaces,
    "hold_listed": resting.hold_to_surfaces,
    "hold_on": resting.hold,
    "has_no_other_side": passing.look_around,
    "settle": resting.find_resting,
    "find_pushes": lifting.find_pushes,
}

_SIDES: dict[str, Function] = {
    "rate_of_switch": sliding_mode.find_rate,
    "take_equivalent_side": sliding_mode.find_equivalent_side,
}

CONTROLS = {
    "measure-density": Flow(step_density.measure_density, parts=_DENSITY),
    "begin-density": Flow(step_density.begin_density, primer="measure-density"),
    "end-density": Flow(step_density.end_density, parts=_DENSITY),
    "measure-density-of-v": Flow(step_density.measure_density, parts=_DENSITY_OF_V),
    "begin-density-of-v": Flow(step_density.begin_density, primer="measure-density-of-v"),
    "end-density-of-v": Flow(step_density.end_density, parts=_DENSITY_OF_V),
    "reflect-density": Flow(step_density.reflect_density, parts=_DENSITY, primer="measure-density"),
    "measure-binding": Flow(time_transformation.measure_binding, parts=_ENERGY),
    "logarithmic-kick": Flow(
        time_transformation.logarithmic_kick,
        parts=_ENERGY,
        evaluations=1,
        moves_v=True,
        again="logarithmic-rekick",
        evaluation="accelerate",
        primer="measure-binding",
    ),
    "logarithmic-rekick": Flow(
        time_transformation.logarithmic_rekick, parts=_ENERGY, moves_v=True, primer="measure-binding"
    ),
    "logarithmic-drift": Flow(
        time_transformation.logarithmic_drift,
        parts=_ENERGY,
        moves_x=True,
        timed=False,
        moves_clock=True,
        primer="measure-binding",
    ),
    "measure-weight": Flow(time_transformation.measure_weight, parts=_DENSITY),
    "transformed-kick": Flow(
        time_transformation.transformed_kick,
        parts={**_DENSITY, "transformed_rekick": time_transformation.kick_again},
        evaluations=1,
        moves_v=True,
        again="transformed-rekick",
        evaluation="accelerate",
        primer="measure-weight",
    ),
    "transformed-rekick": Flow(time_transformation.kick_again, parts=_DENSITY, moves_v=True, primer="measure-weight"),
    "transformed-drift": Flow(
        time_transformation.transformed_drift, moves_x=True, timed=False, moves_clock=True, primer="measure-weight"
    ),
    "choose-first-step": Flow(error_control.choose_first_step, evaluations=1),
    "begin-trial": Flow(error_control.begin_trial, primer="choose-first-step"),
    "end-coarse": Flow(error_control.end_coarse, moves_x=True, moves_v=True, timed=False),
    "judge-embedded": Flow(error_control.judge_embedded, moves_x=True, moves_v=True, timed=False),
    "judge": Flow(error_control.judge, moves_x=True, moves_v=True, timed=False),
    "begin-between": Flow(  # after which the accelerations of before are none
        between.begin_between,
        parts={
            "keep_state": error_control.begin_trial,
            **_SURFACES,
            **_SIDES,
            "take_ahead": sides.take_sides_ahead,
            "find_sides": sides.take_sides,
        },
        keeps_acceleration=False,
    ),
    "end-between": Flow(between.end_between, parts=_SURFACES, moves_x=True, moves_v=True, timed=False),
    "begin-cut": Flow(
        cuts.begin_cut,
        parts={"keep_state": error_control.begin_trial, **_SURFACES, **_SIDES, "slide": sliding_mode.slide},
    ),
    "end-cut": Flow(
        cuts.end_cut,
        parts={
            **_SURFACES,
            "pull_to": impact.accelerate_gap,
            "put_back": impact.move_to_surface,
            "strike": impact.give_impulse,
            "strike_all": impact.strike_rows,
            "gap_on_way": passing.find_gap_on_way,
            "is_unsigned": passing.touches_without_sign,
            "look_for_passes": passing.look_for_unsigned,
            "cross": impact.cross_switch,
            "stop": sliding.stop_slip,
            "misses": sliding_mode.miss_switches,
        },
        moves_x=True,
        moves_v=True,
        timed=False,
    ),
}
