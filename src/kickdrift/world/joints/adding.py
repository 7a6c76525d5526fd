"""Adding joints to a world: one line per kind."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Sequence
from typing import Concatenate, ParamSpec, cast

from kickdrift.core.errors import ArgumentError
from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.joints.ball import Ball
from kickdrift.world.joints.distance import Distance
from kickdrift.world.joints.fixed import Fixed
from kickdrift.world.joints.gear import Gear
from kickdrift.world.joints.handle import Joint
from kickdrift.world.joints.hinge import Hinge
from kickdrift.world.joints.record import Record
from kickdrift.world.joints.registry import Joints
from kickdrift.world.joints.rope_joint import Rope
from kickdrift.world.joints.six_dof import SixDof
from kickdrift.world.joints.slider import Slider
from kickdrift.world.joints.spring import Spring
from kickdrift.world.joints.universal import Universal
from kickdrift.world.layout import BODY_KIND, DYNAMIC
from kickdrift.world.tables import BODY, Tables

P = ParamSpec("P")
_TITLE = "Parameters\n----------\n"
_BODIES = "body_a, body_b : Body\n    None is the ground.\n"
_OF_ALL = """
breaking_force, breaking_torque : float
    The joint breaks if its load, averaged over a step, exceeds this; N, N m.
name : str, optional
    For `World.joint`; unique among joints.

Returns
-------
Joint

"""


def _documentation(kind: Callable[..., Record], before: str = "") -> str:
    """Return the docstring of a kind with the parameters that its method has before its own, and that all kinds have."""
    text, _, rest = (inspect.getdoc(kind) or "").partition(_TITLE)
    own, _, after = rest.partition("\n\n")
    return text + _TITLE + before + own + _OF_ALL + after


def _adds(
    method: str, kind: Callable[P, Record]
) -> Callable[Concatenate[AddsJoints, Body | None, Body | None, P], Joint]:
    """Make the method of a world that adds a joint of a kind; its arguments after the bodies are those of the record."""
    known = tuple(inspect.signature(kind).parameters)

    @shows_parameters_of(kind)
    def add(self: AddsJoints, body_a: Body | None, body_b: Body | None, *args: P.args, **kwargs: P.kwargs) -> Joint:
        _check_names(method, known, kwargs)
        return self.add_joint(body_a, body_b, kind(*args, **kwargs))

    _name(add, method, _documentation(kind, _BODIES))
    return cast(Callable[Concatenate["AddsJoints", Body | None, Body | None, P], Joint], add)


def _couples(method: str, kind: Callable[P, Gear]) -> Callable[Concatenate[AddsJoints, P], Joint]:
    """Make the method of a world that adds a gear, which takes joints instead of bodies."""
    known = tuple(inspect.signature(kind).parameters)

    @shows_parameters_of(kind)
    def add(self: AddsJoints, *args: P.args, **kwargs: P.kwargs) -> Joint:
        _check_names(method, known, kwargs)
        gear = kind(*args, **kwargs)
        for name in ("joint_a", "joint_b"):
            self.joints.row(getattr(gear, name), name)
        return self.joints.add(gear, *gear.bodies())

    _name(add, method, _documentation(kind))
    return cast(Callable[Concatenate["AddsJoints", P], Joint], add)


def _name(add: Callable[..., Joint], method: str, documentation: str) -> None:
    add.__name__, add.__qualname__, add.__doc__ = method, f"AddsJoints.{method}", documentation


def _check_names(method: str, known: Sequence[str], given: Iterable[str]) -> None:
    """Refuse arguments that a kind of joint does not have."""
    unknown = [name for name in given if name not in known]
    if unknown:
        raise ArgumentError(f"{unknown[0]}= is not an argument of {method}; it takes {', '.join(known)}.")


class AddsJoints:
    """The methods of a world that add joints, of body b to body a; None is the ground."""

    tables: Tables
    bodies: Bodies
    joints: Joints

    def add_joint(self, body_a: Body | None, body_b: Body | None, record: Record) -> Joint:
        """Join two bodies by a joint whose kind and parameters are a value; `add_hinge` and the like do so for each kind.

        Angles, positions, motors, drives and limits are those of b relative to a. If only one of the two is dynamic, they are
        those of the dynamic one relative to the other, whichever is named first.

        Parameters
        ----------
        body_a, body_b : Body
            None is the ground.
        record : Record
            A kind of joint with its parameters: ``Ball``, ``Hinge``, ``Slider``, ``Fixed``, ``Universal``, ``SixDof``,
            ``Distance``, ``Rope`` or ``Spring`` of ``kickdrift.world.joints.joint_kinds``. The parameters are those of
            `add_hinge` and the like after the bodies. For a gear use `add_gear`.

        Returns
        -------
        Joint
            Its handle, which reads angles and forces and sets motors, drives and limits.

        Raises
        ------
        ArgumentError
            For a body with itself, removed bodies, bodies of which none is dynamic, a gear, and invalid parameters.

        Examples
        --------
        >>> import kickdrift as kd
        >>> from kickdrift.world.joints.joint_kinds import Hinge
        >>> world = kd.World()
        >>> door = world.add_box((1, 0.1, 2), position=(0.5, 0, 1), mass=20.0)
        >>> hinge = world.add_joint(None, door, Hinge(anchor=(0, 0, 1), axis=(0, 0, 1)))
        >>> hinge.angle
        0.0
        """
        if not isinstance(record, Record):
            raise ArgumentError(
                f"record={record!r} is not a kind of joint; give one of kickdrift.world.joints.joint_kinds."
            )
        if isinstance(record, Gear):
            raise ArgumentError(f"record={record!r} couples joints, not bodies; use add_gear with its parameters.")
        row_a, row_b = (
            self.bodies.row(self.bodies.ground if body is None else body, argument)
            for body, argument in ((body_a, "body_a"), (body_b, "body_b"))
        )
        kinds = self.tables.array(BODY)[[row_a, row_b], BODY_KIND]
        if not (kinds == DYNAMIC).any():
            raise ArgumentError(
                "body_a and body_b are both static or kinematic, so no joint can move them; give at least one dynamic"
                " body."
            )
        return self.joints.add(record, row_a, row_b)

    def joint(self, name: str) -> Joint:
        """Return the joint with a name.

        Parameters
        ----------
        name : str

        Returns
        -------
        Joint

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the names.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> rod = world.add_capsule(0.05, 1.0, mass=1.0)
        >>> hinge = world.add_hinge(None, rod, anchor=(0, 0, 0.5), axis=(0, 1, 0), name="hinge")
        >>> world.joint("hinge") == hinge
        True
        """
        return self.joints.handle(self.joints.names.row(name))

    def remove_joint(self, joint: Joint) -> None:
        """Remove a joint.

        Parameters
        ----------
        joint : Joint

        Raises
        ------
        ArgumentError
            If it was removed before.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> rod = world.add_capsule(0.05, 1.0, mass=1.0)
        >>> hinge = world.add_hinge(None, rod, anchor=(0, 0, 0.5), axis=(0, 1, 0))
        >>> world.remove_joint(hinge)
        """
        self.joints.remove(joint)

    add_ball_joint = _adds("add_ball_joint", Ball)
    add_hinge = _adds("add_hinge", Hinge)
    add_slider = _adds("add_slider", Slider)
    add_fixed_joint = _adds("add_fixed_joint", Fixed)
    add_universal_joint = _adds("add_universal_joint", Universal)
    add_six_dof_joint = _adds("add_six_dof_joint", SixDof)
    add_distance_joint = _adds("add_distance_joint", Distance)
    add_rope_joint = _adds("add_rope_joint", Rope)
    add_spring = _adds("add_spring", Spring)
    add_gear = _couples("add_gear", Gear)
