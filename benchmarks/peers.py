"""The Kepler problem in the hands of the peers, each used as favourably as it honestly can be.

A peer is made once and then called with a number of steps. It returns the seconds that they took, without import,
compilation and set-up, and where the body is. All but REBOUND's leapfrog are semi-implicit Euler with the kick first.
"""

import importlib
import time
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.table import Missing

STEP = 0.01
X0, V0 = (1.0, 0.0), (0.0, 1.1)
Peer = Callable[[int], tuple[float, NDArray[np.float64]]]


def package(name: str) -> ModuleType:
    """Import a peer, or say how to get it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise Missing("pip install kickdrift[bench]") from None


def numpy_loop() -> Peer:
    """Write the loop that a person writes."""

    def run(steps: int) -> tuple[float, NDArray[np.float64]]:
        x, v = np.array(X0), np.array(V0)
        started = time.perf_counter()
        for _ in range(steps):
            v += STEP * (-x / np.linalg.norm(x) ** 3)
            x += STEP * v
        return time.perf_counter() - started, x

    return run


def rebound() -> Peer:
    """Use REBOUND's leapfrog for a test particle and a star; `integrate` is no faster than `steps`."""
    library = package("rebound")

    def run(steps: int) -> tuple[float, NDArray[np.float64]]:
        simulation = library.Simulation()
        simulation.integrator, simulation.gravity, simulation.dt = "leapfrog", "basic", STEP
        simulation.add(m=1.0)
        simulation.add(x=X0[0], y=X0[1], vx=V0[0], vy=V0[1])
        simulation.N_active = 1
        started = time.perf_counter()
        simulation.steps(steps)
        seconds = time.perf_counter() - started
        return seconds, np.array([simulation.particles[1].x, simulation.particles[1].y])

    return run


def diffrax(saved: int | None = 1) -> Peer:
    """Use diffrax's SemiImplicitEuler, jitted, and keep the end alone, so many equidistant times, or (None) every step.

    Its first term moves the first half of the state; given the velocity first, it kicks first.
    """
    library, jax = package("diffrax"), package("jax")
    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy

    def acceleration(t: Any, x: Any, args: Any) -> Any:
        r2 = jnp.dot(x, x)
        return -x / (r2 * jnp.sqrt(r2))

    terms = library.ODETerm(acceleration), library.ODETerm(lambda t, v, args: v)

    def solve(start: Any, steps: int) -> Any:
        end, most = steps * STEP, None
        if saved is None:
            saveat, most = library.SaveAt(steps=True), steps + 1  # its clock may need a step more, of a rounding
        elif saved == 1:
            saveat = library.SaveAt(t1=True)
        else:
            saveat = library.SaveAt(ts=jnp.linspace(0.0, end, saved + 1))
        solver, adjoint = library.SemiImplicitEuler(), library.ForwardMode()
        solution = library.diffeqsolve(
            terms, solver, 0.0, end, STEP, start, saveat=saveat, max_steps=most, adjoint=adjoint, throw=False
        )
        return solution.ys  # velocities too: XLA leaves out what is not returned

    jitted, start = jax.jit(solve, static_argnums=1), (jnp.array(V0), jnp.array(X0))

    def run(steps: int) -> tuple[float, NDArray[np.float64]]:
        jax.block_until_ready(jitted(start, steps))  # compiles for this number of steps
        started = time.perf_counter()
        _, x = jax.block_until_ready(jitted(start, steps))
        return time.perf_counter() - started, np.asarray(x[-1 if saved is not None else steps - 1])

    return run


def symplecta() -> Peer:
    """Use symplecta's symplectic Euler without `t_eval`, which would add a spline through all steps."""
    library = package("symplecta")

    def force(t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        acceleration: NDArray[np.float64] = -x / np.dot(x, x) ** 1.5
        return acceleration

    def run(steps: int) -> tuple[float, NDArray[np.float64]]:
        span = (0.0, steps * STEP)
        started = time.perf_counter()
        result = library.solve_symplectic_ivp(span, X0, V0, force=force, method="symplectic_euler", n_steps=steps)
        x: NDArray[np.float64] = result.q[:, -1]
        return time.perf_counter() - started, x

    return run
