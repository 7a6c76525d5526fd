"""What is set on a live page: buttons, and sliders of the world and of its joints."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from kickdrift.viewer.live_world import LiveWorld
from kickdrift.world.joints.handle import Joint
from kickdrift.world.joints.layout import ANGULAR, SWING_TWIST
from kickdrift.world.tables import JOINT
from kickdrift.world.world import World

Do = Callable[[Callable[[], None]], None]
Axes = list[tuple[str, Joint, int]]  # what to call each, its joint, and which axis it is
_SPEEDS = (0.05, 4.0)
_SUBSTEPS = 32  # at most, or those that the world has
_MOST_SLIDERS = 40  # of joints
_WIDE = (1.0, 3.14)  # m and rad on either side of the target, where a joint has no limits
_FAST = (2.0, 10.0)  # m/s and rad/s, or twice the present speed of a motor if that is more


class Controls:
    """Buttons and sliders of a live page.

    Parameters
    ----------
    gui : viser.GuiApi
    live : LiveWorld
    do : callable
        Takes what is to be done between two steps, and returns at once.
    """

    def __init__(self, gui: Any, live: LiveWorld, do: Do) -> None:
        self._live, self._do = live, do
        self._shown: list[tuple[Any, Callable[[], Any]]] = []  # what a handle shows, and how the world has it
        self._line = gui.add_markdown(live.words())
        self._play = gui.add_button("Play")
        self._play.on_click(lambda _: do(self._play_or_pause))
        gui.add_button("Step").on_click(lambda _: do(live.do_step))
        gui.add_button("Reset").on_click(lambda _: do(self._reset))
        speed = gui.add_slider("Speed", *_SPEEDS, _SPEEDS[0], live.speed, hint="Seconds of the world in a second")
        self._follow(speed, lambda: live.speed, lambda value: setattr(live, "speed", value))
        contacts = gui.add_checkbox("Contact points", False, hint="Where bodies press on each other")
        self._follow(contacts, lambda: live.shows_contacts, lambda value: setattr(live, "shows_contacts", value))
        with gui.add_folder("World"):
            self._add_settings(gui)
        self._add_axes(gui, "Targets of joints", driven_axes(live.world), self._add_target)
        self._add_axes(gui, "Speeds of motors", motor_axes(live.world), self._add_speed)

    def show(self) -> None:
        """Send what has changed in words and on the button."""
        for handle, what, value in (
            (self._line, "content", self._live.words()),
            (self._play, "label", "Pause" if self._live.playing else "Play"),
        ):
            if getattr(handle, what) != value:
                setattr(handle, what, value)

    def _play_or_pause(self) -> None:
        (self._live.pause if self._live.playing else self._live.play)()

    def _reset(self) -> None:
        self._live.reset()
        for handle, value in self._shown:
            handle.value = value()

    def _follow(self, handle: Any, value: Callable[[], Any], change: Callable[[Any], None]) -> None:
        """Have the world take what a page says, and the page what the world has after a reset."""
        self._shown.append((handle, value))

        def take(event: Any) -> None:
            if event.client is not None:  # and not what was shown after a reset
                self._do(lambda: change(handle.value))

        handle.on_update(take)

    def _add_settings(self, gui: Any) -> None:
        world = self._live.world
        gravity = gui.add_vector3("Gravity", tuple(world.gravity.tolist()), step=0.1, hint="m/s^2")
        self._follow(gravity, lambda: tuple(world.gravity.tolist()), lambda value: setattr(world, "gravity", value))
        most = max(_SUBSTEPS, world.substeps)
        substeps = gui.add_slider("Substeps", 1, most, 1, world.substeps, hint="More make contacts stiffer")
        self._follow(substeps, lambda: world.substeps, lambda value: setattr(world, "substeps", value))
        sleeping = gui.add_checkbox("Sleeping", world.sleeping, hint="Skip islands at rest")
        self._follow(sleeping, lambda: world.sleeping, lambda value: setattr(world, "sleeping", value))

    def _add_axes(self, gui: Any, title: str, axes: Axes, add: Callable[[Any, str, Joint, int], None]) -> None:
        if not axes:
            return
        with gui.add_folder(title):
            for name, joint, axis in axes[:_MOST_SLIDERS]:
                add(gui, name, joint, axis)
            if len(axes) > _MOST_SLIDERS:
                gui.add_markdown(f"and {len(axes) - _MOST_SLIDERS} more that have no slider here")

    def _add_target(self, gui: Any, name: str, joint: Joint, axis: int) -> None:
        target, aim = _law_of(joint.drive, joint.set_drive, "target", axis)
        now, wide = target(), _WIDE[axis >= 3]
        low, high = joint.limits(axis) or (-math.inf, math.inf)
        low, high = min(now, max(low, round(now - wide, 2))), max(now, min(high, round(now + wide, 2)))
        slider = gui.add_slider(name, low, high, wide / 200, now, hint="rad" if axis >= 3 else "m")
        self._follow(slider, target, aim)

    def _add_speed(self, gui: Any, name: str, joint: Joint, axis: int) -> None:
        speed, turn = _law_of(joint.motor, joint.set_motor, "speed", axis)
        now = speed()
        most = max(_FAST[axis >= 3], 2.0 * abs(now))
        slider = gui.add_slider(name, -most, most, most / 100, now, hint="rad/s" if axis >= 3 else "m/s")
        self._follow(slider, speed, turn)


def _law_of(
    read: Callable[[int], Any], write: Callable[[Any, int], None], field: str, axis: int
) -> tuple[Callable[[], float], Callable[[float], None]]:
    """Return how to read and to change a number of the drive or motor of an axis; 0.0 and nothing once that is gone."""

    def value() -> float:
        return float(getattr(read(axis), field, 0.0))

    def change(wanted: float) -> None:
        if (law := read(axis)) is not None:
            write(replace(law, **{field: wanted}), axis)

    return value, change


def driven_axes(world: World) -> Axes:
    """Return the axes whose drives pull to a target that can be changed: what to call each, its joint, and which it is."""

    def is_driven(joint: Joint, axis: int) -> bool:
        drive = joint.drive(axis)
        return drive is not None and drive.stiffness > 0.0

    return _axes_of(world, is_driven)


def motor_axes(world: World) -> Axes:
    """Return the axes with motors, likewise."""
    return _axes_of(world, lambda joint, axis: joint.motor(axis) is not None)


def _axes_of(world: World, wanted: Callable[[Joint, int], bool]) -> Axes:
    found = []
    for joint in world.joints:
        last = 3 if world.tables.array(JOINT)[joint.index, ANGULAR] == SWING_TWIST else 6
        axes = [axis for axis in range(last) if wanted(joint, axis)]
        name = joint.name or f"joint {joint.index}"
        found += [(name if len(axes) == 1 else f"{name}, axis {axis}", joint, axis) for axis in axes]
    return found
