"""Adding bodies to a world, finding them by name, and removing them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kickdrift.core.errors import ArgumentError
from kickdrift.core.signatures import shows_parameters_of
from kickdrift.world.argument_checks import choice, number, unit_quaternion, vector
from kickdrift.world.bodies.body_mass import mass_properties_of
from kickdrift.world.bodies.handle import Body
from kickdrift.world.bodies.part import Part, surface_of
from kickdrift.world.bodies.registry import GROUND, Bodies
from kickdrift.world.bodies.shape_rows import Placed, ShapeRows, Surface
from kickdrift.world.collision.broad_phase.filters_and_sensors import forget
from kickdrift.world.contact_events import forget_contacts
from kickdrift.world.deformables.registry import Cloths
from kickdrift.world.joints.registry import Joints
from kickdrift.world.layout import BOUNDING_RADIUS, DYNAMIC, KINEMATIC, STATIC
from kickdrift.world.shapes.mass_properties import rotation_matrix
from kickdrift.world.shapes.record import Shape
from kickdrift.world.tables import MOTION, RESTED, Tables
from kickdrift.world.world_lock import undivided

_UPRIGHT = (1.0, 0.0, 0.0, 0.0)


class AddsBodies:
    """The methods of a world that add and remove bodies."""

    tables: Tables
    bodies: Bodies
    joints: Joints
    cloths: Cloths
    shape_rows: ShapeRows

    @undivided
    @shows_parameters_of(Surface)
    def add_body(
        self,
        shapes: Shape | Sequence[Part],
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: ArrayLike = _UPRIGHT,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        density: float | None = None,
        mass: float | None = None,
        inertia: ArrayLike | None = None,
        centre: ArrayLike | None = None,
        static: bool = False,
        kinematic: bool = False,
        damping: float = 0.0,
        angular_damping: float = 0.0,
        locked_rotation: bool = False,
        name: str | None = None,
        **surface: Any,
    ) -> Body:
        """Add a body of one shape or several.

        Parameters
        ----------
        shapes : Shape or sequence of Part
            Its shapes.
        position : (3,) array_like
            Position of the origin of its shapes, m. `World.position` is the centre of mass, which may be a different point.
        orientation : (4,) array_like
            Quaternion (w, x, y, z) that turns the body's axes into the world's.
        velocity : (3,) array_like
            Of the centre of mass, m/s.
        angular_velocity : (3,) array_like
            In the world's axes, rad/s.
        density : float, optional
            kg/m^3; 1000 if neither it nor the mass is given.
        mass : float, optional
            kg.
        inertia : (3,) or (3, 3) array_like, optional
            About the centre of mass in the body's axes, kg m^2; from the shapes by default.
        centre : (3,) array_like, optional
            Centre of mass, relative to the origin of the shapes in the body's axes, m; requires the inertia. From the
            shapes by default.
        static, kinematic : bool
            A static body never moves; a kinematic one moves with the given velocity, unaffected by forces.
        damping, angular_damping : float
            Rates in 1/s at which velocities decay.
        locked_rotation : bool
            Whether it cannot rotate, as if its inertia were infinite: for characters that stay upright.
        name : str, optional
            For `World.body`, and used in errors and recordings; unique in the world.
        **surface
            `friction`, `restitution`, `rolling_resistance`, `surface_velocity`, `layer`, `collides_with` and `sensor`, as
            in `Surface`.

        Returns
        -------
        Body
            Handle with the row of the body.

        Raises
        ------
        ArgumentError
            For invalid sizes, masses, inertias and poses, and for a name that another body has.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> parts = [kd.Part(kd.Sphere(0.1), position=(x, 0, 0)) for x in (-0.5, 0.5)]
        >>> dumbbell = world.add_body(parts, position=(0, 0, 1), density=1000.0, name="dumbbell")
        >>> round(dumbbell.mass, 3)
        8.378
        """
        name = self.bodies.names.checked(name)
        parts = list(shapes) if isinstance(shapes, Sequence) else [Part(shapes)]
        if not parts or not all(isinstance(part, Part) for part in parts):
            raise ArgumentError(f"shapes={shapes!r} must be a shape, or a sequence of at least one Part.")
        kind = _kind_of(static, kinematic)
        origin, turn = vector("position", position, 3), unit_quaternion("orientation", orientation)
        motion = np.concatenate((vector("velocity", velocity, 3), vector("angular_velocity", angular_velocity, 3)))
        if kind == STATIC and motion.any():
            raise ArgumentError(
                f"velocity={velocity!r} and angular_velocity={angular_velocity!r} of a static body must be zero; use"
                " kinematic=True for a body that moves."
            )
        if choice("locked_rotation", locked_rotation) and (kind != DYNAMIC or motion[3:].any()):
            raise ArgumentError(
                "locked_rotation=True is for dynamic bodies without angular_velocity; leave one of them out."
            )
        surfaces = [surface_of({**surface, **part.surface}) for part in parts]
        weight = mass_properties_of(parts, density, mass, inertia, centre) if kind == DYNAMIC else None
        rates = [number("damping", damping, "1/s"), number("angular_damping", angular_damping, "1/s")]
        middle = np.zeros(3) if weight is None else weight.centre
        body = self.bodies.add(kind, origin + rotation_matrix(turn) @ middle, turn)
        self.tables.array(MOTION)[body.index, :6] = motion
        if weight is not None:
            self.bodies.set_mass(body.index, weight, rates, locked_rotation)
        for part, face in zip(parts, surfaces, strict=True):
            arm = part.position - middle
            arm.flags.writeable = False
            rested = self.tables.array(RESTED)[body.index]
            rested[BOUNDING_RADIUS] = max(rested[BOUNDING_RADIUS], float(np.linalg.norm(arm)) + part.shape.reach)
            self.shape_rows.add(body.index, Placed(part.shape, arm, part.orientation, face))
        self.bodies.names.give(body.index, name)
        if kind != DYNAMIC:  # a dynamic one wakes the bodies that it touches
            self.bodies.wake()
        return self.bodies.handle(body.index)

    def body(self, name: str) -> Body:
        """Return the body with a name.

        Parameters
        ----------
        name : str

        Returns
        -------
        Body

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the names.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, name="ball")
        >>> world.body("ball") == ball
        True
        """
        return self.bodies.handle(self.bodies.names.row(name))

    @undivided
    def remove(self, body: Body) -> None:
        """Remove a body with its shapes and joints, and release cloth pinned to it; its row is reused.

        Parameters
        ----------
        body : Body

        Raises
        ------
        ArgumentError
            If it has been removed before, or is the ground.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1)
        >>> world.remove(ball)
        """
        row = self.bodies.row(body)
        if row == GROUND:
            raise ArgumentError("body is the ground of the world, which cannot be removed; remove another body.")
        self.joints.remove_of_body(row)
        self.cloths.release(row)
        self.bodies.wake()
        self.bodies.remove(body)
        self.shape_rows.remove_of(row)
        forget(self.tables, row)
        forget_contacts(self.tables, row)


def _kind_of(static: bool, kinematic: bool) -> int:
    """Return STATIC, KINEMATIC or DYNAMIC; ArgumentError if both flags are set."""
    static, kinematic = choice("static", static), choice("kinematic", kinematic)
    if static and kinematic:
        raise ArgumentError(
            "static=True and kinematic=True are mutually exclusive: a kinematic body has a velocity; choose one."
        )
    return STATIC if static else KINEMATIC if kinematic else DYNAMIC
