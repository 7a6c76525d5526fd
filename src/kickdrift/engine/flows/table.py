"""The table of flows. A new flow is its function and a line here."""

from kickdrift.core.compilation import Function
from kickdrift.engine.flows import (
    adjoint,
    constraint_rows,
    constraints,
    damping,
    doubled,
    encounters,
    extrapolation,
    gradient_kick,
    implicit,
    kepler,
    kick_drift,
    linearly_implicit,
    magnetic,
    newton,
    noise,
    oscillation,
    runge_kutta,
    stiff,
    substeps,
    sweep,
)
from kickdrift.engine.flows.control_table import CONTROLS
from kickdrift.engine.flows.record import Ahead, Flow


def _solving(residual: Function, **parts: Function) -> dict[str, Function]:
    return {
        **parts,
        "residual": residual,
        "form_matrix": newton.form_matrix_by_differences,
        "newton": newton.newton,
        "solve": implicit.solve,
    }


def _projecting(leave_over: Function, excess_of: Function, renew: Function) -> dict[str, Function]:
    return {
        "jacobian": constraints.jacobian_here,
        "linearise": constraints.linearise_constraints,
        "leave_over": leave_over,
        "excess_of": excess_of,
        "renew": renew,
        "project": constraints.project_state,
    }


_MOTIONS = ((1, 1), (2, 2), (3, 3), (4, 4))  # numbers of x and of v of small states,
_RATES = ((1, 0), (2, 0), (3, 0), (4, 0))  # and of those that are x alone


def _tableaux(sizes: tuple[tuple[int, int] | None, ...], general: bool, stages: tuple[int, ...]) -> tuple[Ahead, ...]:
    return tuple((size, {"STAGES": count, "GENERAL": general}) for size in sizes for count in stages)


# Rods in a plane, one in space, two in a plane
_PENDULUMS = tuple(((n, n), {"COUNT": count}) for n, count in ((2, 1), (3, 1), (4, 2)))


FLOWS = {
    "kick": Flow(
        kick_drift.kick,
        small=kick_drift.kick_small,
        inlined=("acceleration",),
        evaluations=1,
        moves_v=True,
        merges=True,
        again="rekick",
        evaluation="accelerate",
        companion="jump",
        plain=True,
    ),
    "rekick": Flow(kick_drift.rekick, moves_v=True, plain=True),
    "accelerate": Flow(kick_drift.accelerate, inlined=("acceleration",), evaluations=1, plain=True),
    "drift": Flow(kick_drift.drift, moves_x=True, merges=True, along="drift-along", plain=True),
    "drift-along": Flow(kick_drift.drift_along, inlined=("velocity",), moves_x=True, sees_v_clock=True),
    "adjoint-kick": Flow(
        adjoint.adjoint_kick,
        parts=_solving(adjoint.kick_residual),
        moves_v=True,
        keeps_acceleration=False,
        memory=adjoint.memory_size,
        scratch=adjoint.scratch_size,
    ),
    "adjoint-drift": Flow(
        adjoint.adjoint_drift,
        parts=_solving(adjoint.drift_residual),
        moves_x=True,
        sees_v_clock=True,
        memory=adjoint.memory_size,
        scratch=adjoint.scratch_size,
    ),
    "damp": Flow(damping.damp, moves_v=True),
    "damped-drift": Flow(damping.damped_drift, moves_x=True, moves_v=True),
    "rotate": Flow(magnetic.rotate, moves_v=True),
    "boris-rotate": Flow(magnetic.boris_rotate, moves_v=True),
    "thermostat": Flow(noise.thermostat, parts={"draw": noise.draw}, moves_v=True),
    "noise": Flow(noise.noise, parts={"draw": noise.draw}, moves_v=True),
    "kepler": Flow(kepler.kepler, moves_x=True, moves_v=True),
    "jump": Flow(kepler.jump),  # moves x without effect on the clock or the acceleration of the kicks
    "encounters": Flow(
        encounters.encounters,
        moves_x=True,
        moves_v=True,
        memory=encounters.memory_size,
        by_params=True,
        constants=encounters.constants,
        ahead=((None, {}),),
    ),
    "oscillate": Flow(oscillation.oscillate, moves_x=True, moves_v=True, memory=oscillation.memory_size),
    "filtered-kick": Flow(
        oscillation.filtered_kick,
        moves_v=True,
        keeps_acceleration=False,
        memory=oscillation.memory_size,
        counted=lambda coefficients: 1,
    ),
    "substeps": Flow(
        substeps.substeps,
        moves_x=True,
        moves_v=True,
        memory=substeps.memory_size,
        counted=lambda coefficients: int(coefficients[0]),
    ),
    "sweep": Flow(
        sweep.sweep,
        parts={"evaluate_component": sweep.evaluate_component},
        moves_x=True,
        memory=sweep.memory_size,
        constants=sweep.constants,
    ),
    "adjoint-sweep": Flow(
        sweep.adjoint_sweep,
        parts={"evaluate_component": sweep.evaluate_component, "solve_component": sweep.solve_component},
        moves_x=True,
        memory=sweep.memory_size,
        constants=sweep.constants,
    ),
    "extrapolation": Flow(
        extrapolation.extrapolate,
        parts={
            "kick_residual": adjoint.kick_residual,
            "drift_residual": adjoint.drift_residual,
            **_solving(extrapolation.half_residual),
            "adjoint_kick": adjoint.adjoint_kick,
            "adjoint_drift": adjoint.adjoint_drift,
            "take_symmetric_step": extrapolation.take_kicks_and_drifts,
        },
        moves_x=True,
        moves_v=True,
        memory=extrapolation.memory_size,
        scratch=adjoint.scratch_size,
    ),
    "extrapolated-sweeps": Flow(
        extrapolation.extrapolate,
        parts={
            "evaluate_component": sweep.evaluate_component,
            "solve_component": sweep.solve_component,
            "sweep": sweep.sweep,
            "adjoint_sweep": sweep.adjoint_sweep,
            "take_symmetric_step": extrapolation.take_sweeps,
        },
        moves_x=True,
        memory=extrapolation.memory_size,
    ),
    "double": Flow(doubled.double, memory=doubled.memory_size),
    "doubled-kick": Flow(
        doubled.doubled_kick,
        parts={"evaluate": doubled.evaluate},
        evaluations=1,
        moves_v=True,
        keeps_acceleration=False,
        memory=doubled.memory_size,
        primer="double",
    ),
    "doubled-drift": Flow(
        doubled.doubled_drift,
        parts={"evaluate": doubled.evaluate},
        evaluations=1,
        moves_x=True,
        sees_v_clock=True,
        keeps_acceleration=False,
        memory=doubled.memory_size,
        primer="double",
    ),
    "doubled-binding": Flow(
        doubled.doubled_binding, keeps_acceleration=False, memory=doubled.memory_size, primer="double"
    ),
    "linearly-implicit-kick": Flow(
        linearly_implicit.linearly_implicit_kick,
        parts={"form_velocity_jacobian": linearly_implicit.form_velocity_jacobian},
        moves_v=True,
        keeps_acceleration=False,
        memory=linearly_implicit.memory_size,
        scratch=linearly_implicit.scratch_size,
    ),
    "gradient-kick": Flow(gradient_kick.gradient_kick, evaluations=2, moves_v=True, keeps_acceleration=False),
    "runge-kutta": Flow(
        runge_kutta.runge_kutta,
        parts={"evaluate": runge_kutta.evaluate, "advance": runge_kutta.advance},
        moves_x=True,
        moves_v=True,
        memory=runge_kutta.explicit_memory,
        constants=runge_kutta.constants,
        ahead=_tableaux((*_MOTIONS, None), False, (4, 12)),  # runge-kutta-4 and dop853
    ),
    "implicit-runge-kutta": Flow(
        runge_kutta.implicit_runge_kutta,
        parts=_solving(runge_kutta.stage_residual, evaluate=runge_kutta.evaluate, advance=runge_kutta.advance),
        moves_x=True,
        moves_v=True,
        memory=runge_kutta.implicit_memory,
        scratch=runge_kutta.implicit_scratch,
        constants=runge_kutta.constants,
        ahead=_tableaux(_MOTIONS, False, (2, 3)),  # gauss-4 and gauss-6
    ),
    "stiff-runge-kutta": Flow(
        stiff.stiff_runge_kutta,
        parts={
            **_solving(runge_kutta.stage_residual, evaluate=runge_kutta.evaluate, advance=runge_kutta.advance),
            "estimate": stiff.estimate_errors,
            "take_step": stiff.take_attempt,
        },
        moves_x=True,
        moves_v=True,
        memory=stiff.memory_size,
        scratch=runge_kutta.implicit_scratch,
        constants=runge_kutta.constants,
        ahead=_tableaux(_RATES, True, (3, 4)),  # radau-5 and radau-7
        estimates=True,
    ),
    "linearise-constraints": Flow(
        constraints.linearise_constraints,
        parts={"jacobian": constraints.jacobian_here},
        memory=constraint_rows.memory_size,
        by_params=True,
        constants=constraint_rows.constants,
        ahead=_PENDULUMS,
    ),
    "constrain-positions": Flow(
        constraints.constrain_positions,
        parts=_projecting(constraints.positions_left_over, constraint_rows.farthest, constraints.renew_at_positions),
        moves_x=True,
        moves_v=True,
        timed=False,
        memory=constraint_rows.memory_size,
        by_params=True,
        constants=constraint_rows.constants,
        ahead=_PENDULUMS,
        primer="linearise-constraints",
    ),
    "constrain-velocities": Flow(
        constraints.constrain_velocities,
        parts=_projecting(constraints.velocities_left_over, constraints.nothing_in_excess, constraints.renew_nothing),
        moves_v=True,
        timed=False,
        memory=constraint_rows.memory_size,
        by_params=True,
        constants=constraint_rows.constants,
        ahead=_PENDULUMS,
        primer="linearise-constraints",
    ),
    **CONTROLS,
}
