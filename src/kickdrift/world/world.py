"""A world of rigid bodies, joints, cloth, ropes and soft bodies."""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError
from kickdrift.core.threads import launch
from kickdrift.world import settings
from kickdrift.world.argument_checks import choice, direction, number, vector
from kickdrift.world.batch_view import BATCH_COLOURS
from kickdrift.world.bodies.adding_shapes import AddsShapes
from kickdrift.world.bodies.adding_surfaces import AddsSurfaces
from kickdrift.world.bodies.registry import Bodies
from kickdrift.world.bodies.shape_rows import ShapeRows
from kickdrift.world.bodies.views import BodyViews
from kickdrift.world.conserved_quantities import ConservedQuantities
from kickdrift.world.contact_views import ContactViews
from kickdrift.world.deformables.adding import AddsCloths
from kickdrift.world.deformables.adding_ropes import AddsRopes
from kickdrift.world.deformables.adding_soft_bodies import AddsSoftBodies
from kickdrift.world.deformables.registry import Cloths
from kickdrift.world.force_functions import Force
from kickdrift.world.forces import AppliesForces
from kickdrift.world.joints.adding import AddsJoints
from kickdrift.world.joints.handle import Joint
from kickdrift.world.joints.registry import Joints
from kickdrift.world.query_api import SpatialQueries
from kickdrift.world.recordings.recording_api import KeepsHistory
from kickdrift.world.recordings.recording_rows import Recorder
from kickdrift.world.snapshot import Snapshot
from kickdrift.world.solver_settings import Tunable
from kickdrift.world.step.stage_order import Program
from kickdrift.world.step.stepping import DoesSteps
from kickdrift.world.step.warnings import say
from kickdrift.world.tables import COLOURS, GRAPH, KERNEL_ADDRESSES, SETTINGS, STEP_STATUS, VIEW, Tables


def _revived(kind: type[World], snapshot: Snapshot, threads: bool) -> World:
    """Make a world from a snapshot, without calling the constructor of a subclass."""
    world = kind.__new__(kind)
    World.__init__(world, threads=threads)
    world.restore(snapshot)
    return world


class World(
    DoesSteps,
    KeepsHistory,
    BodyViews,
    ContactViews,
    AddsShapes,
    AddsSurfaces,
    AddsJoints,
    AddsCloths,
    AddsRopes,
    AddsSoftBodies,
    AppliesForces,
    SpatialQueries,
    ConservedQuantities,
    Tunable,
):
    """Rigid bodies, joints, cloth, ropes and soft bodies, in three dimensions or in a plane.

    >>> import kickdrift as kd
    >>> world = kd.World(gravity=(0, 0, -9.81))
    >>> floor = world.add_plane(friction=0.6)
    >>> ball = world.add_sphere(
    ...     radius=0.1, position=(0, 0, 1.1), density=1000.0, restitution=0.8
    ... )
    >>> recording = world.run(duration=2.0, step=1 / 60)

    `add_box` and the like add bodies, `add_hinge` and the like joints; `add_cloth`, `add_rope` and `add_soft_body` add
    deformable bodies, and `add_force` a force of your own. `step` does one step; `run` does many and records them; `record`
    records a loop of your own, and `view` shows the world in the browser. `ray_cast`, `overlap_box`, `touching`, `contacts` and
    `events` are queries; `snapshot`, `restore` and `save` store and recall states.

    Contacts of free bodies are solved iteratively, by sweeps. Bodies connected by joints, and those in contact with them,
    form islands, each of which is solved directly. So are small heaps on which the sweeps do not converge.

    Parameters
    ----------
    gravity : (3,) array_like
        m/s^2.
    substeps : int
        Number of equal parts of a step; contacts and joints are solved in each. More of them make contacts stiffer, and
        resolve faster rotation.
    midpoint : bool
        Whether bodies in free flight move with the mean of their velocities before and after the kick, so that gravity
        conserves energy. Bodies with joints, but without contacts, damping, motors, drives and joint friction, then get half
        of the kick before the drift and half after it (Stoermer-Verlet). If False, all move with the velocity after the kick
        (semi-implicit Euler).
    margin, slop : float
        The distance between shapes at which a contact between them is created, and the depth to which they may overlap; m.
    contact_hertz, contact_damping : float
        Frequency, Hz, and damping ratio of the spring that pushes overlapping bodies apart; by default the frequency is 0.15
        divided by the substep, the stiffest that does not disturb high stacks.
    push_speed : float
        The largest speed at which two overlapping bodies are pushed apart, m/s; once apart, they keep none of it. In a stack
        the speeds add up: of four boxes that overlap each other and the floor, the uppermost rises at up to four times this
        speed.
    bounce_speed : float, optional
        Bodies that approach more slowly do not bounce, m/s; by default four times the speed that gravity or the forces
        on them add in a substep. Nor do those that approach by less than 1e-9 of `slop` in a substep.
    sleeping : bool
        Whether islands, sets of bodies that nearly touch or are joined, are skipped while at rest: once none of their points
        has moved faster than `sleep_speed` for `sleep_time`. Cloths sleep together, once all of them are at rest. Off by
        default, because it removes their remaining kinetic energy.
    sleep_speed, sleep_time : float
        m/s and s, see `sleeping`.
    threads : bool
        Whether contacts and cloths are distributed over Numba's threads (``numba.set_num_threads``); results are
        bit-identical for any number of them. Worthwhile from about a thousand bodies or 5000 particles of a cloth, on
        otherwise idle cores. With Numba's threading layer `workqueue`, that of last resort, cloths take longer than on one
        thread. Processes forked from one that has used threads run on one thread.
    plane_normal : (3,) array_like, optional
        Makes the world planar: bodies move only perpendicular to this direction, and turn only about it. Walls oblique to
        the plane push bodies within it, with the friction of a wedge in its groove. Surfaces nearly parallel to the plane
        are floors, on which bodies slide with friction. The ends of ropes and rods keep their distances from the plane.

    Attributes
    ----------
    position, velocity : (N, 3) array
        Centres of mass in m and their velocities in m/s, one row per body; the ground is row 0. These are live views:
        writing into them moves the bodies. Get them again after adding bodies.
    orientation : (N, 4) array
        Quaternions (w, x, y, z) that turn the bodies' axes into the world's.
    angular_velocity : (N, 3) array
        In the world's axes, rad/s.
    bodies, joints : iterable
        Handles: ``for body in world.bodies``, the ground first; `World.body` and `World.joint` return those of a name.
    gravity, substeps, sleeping
        As above; each may be set between steps.
    residual : float
        The largest normal speed that the solver left at points of contact in the last step, m/s; read-only.
    time : float
        Time since the start, s.
    broken : list of Joint
        Joints that broke in the last call of `step` or `advance`.

    Examples
    --------
    The ball above has fallen, bounced and fallen again:

    >>> recording.x.shape
    (121, 3, 3)
    >>> bool(ball.position[2] < 0.8)
    True
    """

    def __init__(
        self,
        gravity: ArrayLike = (0.0, 0.0, -9.81),
        *,
        substeps: int = 4,
        midpoint: bool = True,
        margin: float = 0.02,
        slop: float = 0.005,
        contact_hertz: float | None = None,
        contact_damping: float = 4.0,
        push_speed: float = 1.5,
        bounce_speed: float | None = None,
        sleeping: bool = False,
        sleep_speed: float = 0.05,
        sleep_time: float = 0.5,
        threads: bool = False,
        plane_normal: ArrayLike | None = None,
    ) -> None:
        self.tables = Tables()
        self.time = 0.0
        self.n_steps, self.counted = 0, (0.0, 0.0, 0)
        row = self.tables.resize(SETTINGS, 1)[0]
        self.shape_rows = ShapeRows(self.tables)
        self.joints = Joints(self.tables)
        self.bodies = Bodies(self.tables, self.shape_rows, self.joints.mass_changed)
        self.cloths = Cloths(self.tables, self.bodies)
        self.bodies.world = self.joints.world = self.cloths.world = weakref.ref(self)
        self.gravity, self.substeps, self.sleeping = vector("gravity", gravity, 3), substeps, sleeping
        row[settings.MIDPOINT] = choice("midpoint", midpoint)
        row[settings.MARGIN] = number("margin", margin, "m", zero=False)
        row[settings.SLOP] = number("slop", slop, "m", zero=False)
        if contact_hertz is not None:
            row[settings.CONTACT_HERTZ] = number("contact_hertz", contact_hertz, "Hz", zero=False)
        row[settings.CONTACT_DAMPING] = number("contact_damping", contact_damping, "1", zero=False)
        row[settings.PUSH_SPEED] = number("push_speed", push_speed, "m/s")
        row[settings.BOUNCE_SPEED] = -1.0 if bounce_speed is None else number("bounce_speed", bounce_speed, "m/s")
        row[settings.SLEEP_SPEED] = number("sleep_speed", sleep_speed, "m/s")
        row[settings.SLEEP_TIME] = number("sleep_time", sleep_time, "s")
        self.threads = choice("threads", threads)
        if threads:
            launch()
        row[settings.RECYCLE_DISTANCE] = 0.5 * margin
        if plane_normal is not None:
            row[settings.PLANE_NORMAL : settings.PLANE_NORMAL + 3] = direction("plane_normal", plane_normal)
        self.planar = plane_normal is not None
        self.tables.resize(STEP_STATUS, 1)
        self.tables.resize(COLOURS, BATCH_COLOURS)
        self.tables.resize(GRAPH, 1)
        self.tables.resize(VIEW, 1)
        self.tables.resize(KERNEL_ADDRESSES, 1)
        self.broken: list[Joint] = []
        self.recorder: Recorder | None = None
        self._said, self._softened, self.compile_time = 0, set(), 0.0
        self._program: Program
        self._program_step, self._breakable, self._threaded = 0.0, False, False
        self._addresses: NDArray[np.intp]
        self._composition: tuple[object, ...] | None = None
        self.forces: list[Force] = []

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle by a snapshot, with the attributes that a subclass or a user has added."""
        known = vars(World())
        added = {name: value for name, value in vars(self).items() if name not in known}
        return _revived, (type(self), self.snapshot(), self.threads), added or None

    def step(self, step: float) -> None:
        """Do one step.

        Parameters
        ----------
        step : float
            s.

        Raises
        ------
        ArgumentError
            For a step that is not positive and finite.
        LostBodyError
            If a body or a cloth is lost to infinity; the world is then restored to its state before the step.
        KickdriftError
            If a force or a wind raises an error; all bodies are then where they were before the step.

        Warns
        -----
        UnsolvedWarning
            Each kind once per world: if joints lose or gain energy because bodies turn too far in a substep, if a body has
            rested for seconds on contacts that the solver leaves unsolved, if a body may have passed through another, and if
            impacts had no end; and for each cloth that the step makes far softer than its material. The message says which
            substeps or steps help.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> world.step(1 / 60)
        >>> round(world.time, 6), ball.velocity.round(4)
        (0.016667, array([ 0.    ,  0.    , -0.1635]))
        """
        self.advance(step, 1)

    def advance(self, step: float, count: int) -> None:
        """Do a number of steps in compiled code: with the same bits, errors and warnings as repeated calls of `step`.

        Parameters
        ----------
        step : float
            s.
        count : int
            Number of steps, zero or more.

        Raises
        ------
        ArgumentError
            For a step that is not positive and finite, and a count that is negative or not a whole number.

        Examples
        --------
        >>> import kickdrift as kd
        >>> world = kd.World()
        >>> ball = world.add_sphere(radius=0.1, mass=1.0)
        >>> world.advance(1 / 60, 60)
        >>> round(world.time, 6)
        1.0
        """
        step = number("step", step, "s; 1/60 is usual", zero=False)
        if not is_whole(count, 0):
            raise ArgumentError(f"count={count!r} must be a whole number of steps, zero or more.")
        t0, length, following = self.counted
        if length != step or t0 + following * length != self.time:
            t0, following = self.time, 0
        self.advance_from(t0, following, step, int(count))

    def advance_from(self, t0: float, first: int, step: float, count: int) -> None:
        """Do `count` steps, the first with number `first` from t0, so that times do not depend on how a run is divided."""
        with self.tables.lock:
            self.broken = []
            found = self.do_steps(t0, first, step, count)
            if found:
                said, self._said = self._said, self._said | found
                say(found, said, self.tables, self.bodies)
