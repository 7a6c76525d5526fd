"""Adding bodies to a world: one method per shape."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import ArgumentError
from kickdrift.world.arguments import choice, number, turn_to, unit_quaternion, vector
from kickdrift.world.bodies import Bodies, kind_of
from kickdrift.world.body import Body
from kickdrift.world.cloth.registry import Cloths
from kickdrift.world.collision.filters import forget
from kickdrift.world.integration import DYNAMIC, STATIC
from kickdrift.world.joints.registry import Joints
from kickdrift.world.mass_properties import mass_properties_of
from kickdrift.world.part import Part, surface_of
from kickdrift.world.shape_rows import Placed, ShapeRows
from kickdrift.world.shapes.box import Box
from kickdrift.world.shapes.capsule import Capsule
from kickdrift.world.shapes.cone import Cone
from kickdrift.world.shapes.cylinder import Cylinder
from kickdrift.world.shapes.heightfield import HeightField
from kickdrift.world.shapes.hull import Hull
from kickdrift.world.shapes.mass import rotation_matrix
from kickdrift.world.shapes.mesh import Mesh
from kickdrift.world.shapes.plane import Plane
from kickdrift.world.shapes.record import Shape
from kickdrift.world.shapes.sphere import Sphere
from kickdrift.world.sleeping import REACH
from kickdrift.world.tables import MOTION, RESTED, Tables
from kickdrift.world.undivided import undivided

Floats = NDArray[np.float64]
_UPRIGHT = (1.0, 0.0, 0.0, 0.0)


class AddsBodies:
    """The methods of a world that add bodies."""

    tables: Tables
    bodies: Bodies
    joints: Joints
    cloths: Cloths
    shape_rows: ShapeRows

    def add_sphere(self, radius: float, **options: Any) -> Body:
        """Add a ball of a radius in m; options as in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, position=(0, 0, 1), density=1000.0, restitution=0.8)
        >>> round(ball.mass, 3)
        4.189
        """
        return self.add_body(Sphere(radius), **options)

    def add_capsule(self, radius: float, length: float, **options: Any) -> Body:
        """Add a cylinder along z with hemispherical caps; options as in `add_body`.

        Parameters
        ----------
        radius, length : float
            In m; the length is that of the cylinder between the caps.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> rod = world.add_capsule(radius=0.1, length=1.0, position=(0, 0, 1), mass=2.0)
        >>> rod.mass
        2.0
        """
        return self.add_body(Capsule(radius, length), **options)

    def add_cylinder(self, radius: float, length: float, **options: Any) -> Body:
        """Add a cylinder about z, centred at its origin, with a radius and a length in m; options as in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> can = world.add_cylinder(radius=0.1, length=0.3, position=(0, 0, 0.15), mass=1.0)
        >>> round(float(can.inertia[2, 2]), 6)
        0.005
        """
        return self.add_body(Cylinder(radius, length), **options)

    def add_cone(self, radius: float, length: float, **options: Any) -> Body:
        """Add a cone about z with a radius and a length in m; options as in `add_body`.

        The position passed in is halfway between base and tip; the position of the body is its centre of mass.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> cone = world.add_cone(radius=0.1, length=0.4, mass=1.0)
        >>> cone.position.round(6)
        array([ 0. ,  0. , -0.1])
        """
        return self.add_body(Cone(radius, length), **options)

    def add_box(self, size: ArrayLike, **options: Any) -> Body:
        """Add a box with three full edge lengths in m; options as in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> box = world.add_box(size=(1, 1, 1), position=(0, 0, 0.5), mass=50.0, friction=0.6)
        >>> box.position
        array([0. , 0. , 0.5])
        """
        return self.add_body(Box(size), **options)

    def add_hull(self, points: ArrayLike, **options: Any) -> Body:
        """Add the convex hull of (N, 3) points in m; options as in `add_body`.

        The position passed in is that of the origin of the points; the position of the body is its centre of mass.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> wedge = world.add_hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], density=600.0)
        >>> round(wedge.mass, 6)
        100.0
        """
        return self.add_body(Hull(points), **options)

    def add_plane(
        self, normal: ArrayLike = (0.0, 0.0, 1.0), point: ArrayLike = (0.0, 0.0, 0.0), **options: Any
    ) -> Body:
        """Add the half-space under a plane, which never moves.

        Parameters
        ----------
        normal : (3,) array_like
            Its outward normal; any length but zero.
        point : (3,) array_like
            Any point of the plane, m.
        **options
            As in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> floor = world.add_plane(normal=(0, 0, 1), friction=0.6)
        >>> ball = world.add_sphere(radius=0.1, position=(0, 0, 0.1), mass=1.0)
        >>> world.advance(1 / 60, 60)
        >>> bool(abs(ball.position[2] - 0.1) < 1e-3)
        True
        """
        return self.add_body(Plane(), position=point, orientation=turn_to(normal), static=True, **options)

    def add_mesh(self, vertices: ArrayLike, faces: ArrayLike, **options: Any) -> Body:
        """Add an immovable triangle mesh.

        Parameters
        ----------
        vertices : (N, 3) array_like
            m.
        faces : (M, 3) array_like of int
            Indices of vertices, counter-clockwise as seen from outside.
        **options
            As in `add_body`.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> slab = world.add_mesh([(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [(0, 1, 2)])
        >>> world.ray_cast(origin=(0, 0, 5), direction=(0, 0, -1)).distance
        5.0
        """
        return self.add_body(Mesh(vertices, faces), static=True, **options)

    def add_height_field(self, heights: ArrayLike, spacing: float, **options: Any) -> Body:
        """Add an immovable height field.

        Parameters
        ----------
        heights : (K, L) array_like
            z in m, along x and y.
        spacing : float
            Distance between neighbouring heights, m.
        **options
            As in `add_body`.

        Examples
        --------
        >>> import numpy as np, kickdrift as kd
        >>> world = kd.World()
        >>> hills = world.add_height_field(np.full((5, 5), 0.5), spacing=1.0)
        >>> round(world.ray_cast(origin=(0.2, 0.1, 5), direction=(0, 0, -1)).distance, 6)
        4.5
        """
        return self.add_body(HeightField(heights, spacing), static=True, **options)

    @undivided
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
            kg/m^3; 1000 where neither it nor the mass is given.
        mass : float, optional
            kg.
        inertia : (3,) or (3, 3) array_like, optional
            About the centre of mass in the body's axes, kg m^2; from the shapes by default.
        centre : (3,) array_like, optional
            Centre of mass, relative to the origin of the shapes in the body's axes, m, if it is not that of the shapes;
            requires the inertia.
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
            For sizes, masses, inertias and poses that no body can have, and for the name of another body.

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
        kind = kind_of(static, kinematic)
        origin, turn = vector("position", position, 3), unit_quaternion("orientation", orientation)
        motion = np.concatenate((vector("velocity", velocity, 3), vector("angular_velocity", angular_velocity, 3)))
        if kind == STATIC and motion.any():
            raise ArgumentError("velocity of a static body must be zero; use kinematic=True for a body that moves.")
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
            rested[REACH] = max(rested[REACH], float(np.linalg.norm(arm)) + part.shape.reach)
            self.shape_rows.add(body.index, Placed(part.shape, arm, part.orientation, face))
        self.bodies.names.give(body.index, name)
        return self.bodies.handle(body.index)

    def body(self, name: str) -> Body:
        """Return the body with a name.

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
        """Remove a body with its shapes and joints, and release what is pinned to it; its row is reused.

        Raises
        ------
        ArgumentError
            If it has been removed before.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1)
        >>> world.remove(ball)
        """
        row = self.bodies.row(body)
        self.joints.remove_of_body(row)
        self.cloths.release(row)
        self.bodies.wake()
        self.bodies.remove(body)
        self.shape_rows.remove_of(row)
        forget(self.tables, row)
