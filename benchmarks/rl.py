"""The loop of reinforcement learning: a cart with a pole, whose state is read, which is pushed, and which does a step."""

import time
from collections.abc import Callable
from functools import partial
from typing import Protocol

import numpy as np

from benchmarks.peers import package
from benchmarks.table import Missing, Row, at_least, measured, skipped
from benchmarks.turns import in_turns, nanoseconds, ratio
from kickdrift.world.joints.limits_motors_options import Motor
from kickdrift.world.world import World

_STEP, _TILT = 1 / 60, 0.05
_EPISODE, _EPISODES = 200, 10
_CART, _POLE, _LENGTH, _RADIUS = 1.0, 0.1, 1.0, 0.05  # kg, kg, m, m

_MJCF = f"""
<mujoco>
  <option timestep="{{step}}"/>
  <worldbody>
    <body>
      <joint name="slider" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.2 0.1 0.1" mass="{_CART}" contype="0" conaffinity="0"/>
      <body>
        <joint name="hinge" type="hinge" axis="0 1 0"/>
        <geom type="capsule" size="{_RADIUS}" fromto="0 0 0 0 0 {_LENGTH}" mass="{_POLE}" contype="0" conaffinity="0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="slider"/></actuator>
</mujoco>
"""


class CartPole(Protocol):
    """A cart on rails along x with a pole that is to be kept upright."""

    def reset(self) -> None:
        """Begin an episode."""
        ...

    def state(self) -> tuple[float, float, float, float]:
        """Angle and rate of the pole, place and speed of the cart."""
        ...

    def act(self, push: float) -> None:
        """Push the cart, and do a step."""
        ...


class Kickdrift:
    """By handles of joints, as its users write it."""

    def __init__(self, step: float = _STEP) -> None:
        self.world, self._step = World(), step
        self.cart = self.world.add_box((0.4, 0.2, 0.2), mass=_CART)
        self.pole = self.world.add_capsule(_RADIUS, _LENGTH, position=(0, 0, 0.5 * _LENGTH), mass=_POLE)
        self.slider = self.world.add_slider(None, self.cart, anchor=(0, 0, 0), axis=(1, 0, 0))
        self.hinge = self.world.add_hinge(self.cart, self.pole, anchor=(0, 0, 0), axis=(0, 1, 0))
        self.hinge.angle = _TILT
        self._start = self.world.snapshot()

    def reset(self) -> None:
        """Go back to the snapshot."""
        self.world.restore(self._start)

    def state(self) -> tuple[float, float, float, float]:
        """Read the joints."""
        return self.hinge.angle, self.hinge.speed, self.slider.position, self.slider.speed

    def act(self, push: float) -> None:
        """Push by an effort of the slider."""
        self.slider.apply_effort(push)
        self.world.step(self._step)


class ByArrays(Kickdrift):
    """By the arrays of the world, and a force on the cart."""

    def state(self) -> tuple[float, float, float, float]:
        """Read positions and velocities; the angle is that of the quaternion."""
        cart, pole = self.cart.index, self.pole.index
        world = self.world
        q = world.orientation[pole]
        return 2.0 * q[2], world.angular_velocity[pole, 1], world.position[cart, 0], world.velocity[cart, 0]

    def act(self, push: float) -> None:
        """Push by a force."""
        self.world.apply_force(self.cart, (push, 0.0, 0.0))
        self.world.step(self._step)


class ByMotor(Kickdrift):
    """By a motor of the slider, whose speed is exchanged in each step."""

    def act(self, push: float) -> None:
        """Let the motor lead to the speed that the push would."""
        self.slider.set_motor(Motor(self.slider.speed + push / (_CART + _POLE) * self._step, 50.0))
        self.world.step(self._step)


class Mujoco:
    """MuJoCo by its Python bindings, with its defaults."""

    def __init__(self, step: float = _STEP) -> None:
        self._library = package("mujoco")
        self._model = self._library.MjModel.from_xml_string(_MJCF.format(step=step))
        self._data = self._library.MjData(self._model)

    def reset(self) -> None:
        """Reset, and tilt the pole."""
        self._library.mj_resetData(self._model, self._data)
        self._data.qpos[1] = _TILT

    def state(self) -> tuple[float, float, float, float]:
        """Read positions and velocities."""
        (x, angle), (v, rate) = self._data.qpos, self._data.qvel
        return angle, rate, x, v

    def act(self, push: float) -> None:
        """Push by the control of a motor."""
        self._data.ctrl[0] = push
        self._library.mj_step(self._model, self._data)


def policy(angle: float, rate: float, place: float, speed: float) -> float:
    """Push that keeps the pole upright and the cart in its place, N."""
    return 30.0 * angle + 6.0 * rate + 1.0 * place + 2.0 * speed


def episode(cart: CartPole, steps: int = _EPISODE) -> None:
    """Read, act and step."""
    cart.reset()
    for _ in range(steps):
        cart.act(policy(*cart.state()))


def compare(rounds: int) -> list[Row]:
    """Nanoseconds a step of the loop, resets among them."""
    ways: dict[str, type[Kickdrift]] = {"kickdrift": Kickdrift, "arrays": ByArrays, "motor": ByMotor}
    carts: dict[str, CartPole] = {name: make() for name, make in ways.items()}
    missing = ""
    try:
        carts["MuJoCo"] = Mujoco()
        _check_they_do_the_same()
    except Missing as error:
        missing = str(error)
    contestants: dict[str, Callable[[], float]] = {name: partial(_cost, cart) for name, cart in carts.items()}
    contestants["advance"] = partial(_cost_of_advance, Kickdrift())
    costs = in_turns(contestants, rounds)
    note = nanoseconds(costs, *contestants)
    rows = [
        measured("cart-pole, steps of the loop in a second", 1e9 / costs["kickdrift"], at_least(30_000, "/s"), note),
        measured("state from the world's arrays, push by apply_force", 1e9 / costs["arrays"], at_least(30_000, "/s")),
        measured("push by set_motor", 1e9 / costs["motor"], at_least(30_000, "/s")),
        measured("advance, many steps in a call", 1e9 / costs["advance"], unit="/s"),
        measured("loop / advance", ratio(costs, "kickdrift", "advance")),
    ]
    if missing:
        return [*rows, skipped("kickdrift / MuJoCo", missing)]
    return [
        *rows,
        measured("MuJoCo, steps of the loop in a second", 1e9 / costs["MuJoCo"], unit="/s"),
        measured("kickdrift, four substeps / MuJoCo", ratio(costs, "kickdrift", "MuJoCo")),
    ]


def _cost(cart: CartPole) -> float:
    started = time.perf_counter()
    for _ in range(_EPISODES):
        episode(cart)
    return (time.perf_counter() - started) / (_EPISODES * _EPISODE) * 1e9


def _cost_of_advance(cart: Kickdrift) -> float:
    cart.reset()
    started = time.perf_counter()
    cart.world.advance(_STEP, _EPISODES * _EPISODE)
    return (time.perf_counter() - started) / (_EPISODES * _EPISODE) * 1e9


def _check_they_do_the_same() -> None:
    """Compare them after a second of small steps, in which the pole is put up."""
    step = 2.5e-4  # MuJoCo's integrator is of first order
    ends = []
    for make in (Kickdrift, ByArrays, Mujoco):
        cart = make(step)
        episode(cart, 4000)
        ends.append(cart.state())
    if not np.allclose(ends, ends[0], 0.0, 5e-4):
        raise AssertionError(f"the carts end differently: {ends}")
