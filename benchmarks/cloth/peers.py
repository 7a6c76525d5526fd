"""The cloth on a ball in the hands of the peers, one thread each."""

import logging
import os
from typing import Any

import numpy as np

from benchmarks.cloth.scene import DAMPING, DENSITY, FRAME, HEIGHT, RADIUS, SIZE, THICKNESS, Draped
from benchmarks.peers import package
from benchmarks.table import Missing

_STEP = 0.002  # s, of MuJoCo: at 1/60 s its cloth is thrown about
# Particles on a side in MuJoCo, which takes minutes to compile more, and seconds for a step; and in Newton
_LARGEST = 40
_SUBSTEPS = 5  # of pyPBD
_NEWTONS_SUBSTEPS = 10


class Rapier(Draped):
    """rapier3d's soft body of springs along edges and diagonals, with its defaults."""

    def __init__(self, side: int, meets: bool) -> None:
        library = package("rapier3d")
        self._world = library.PhysicsWorld(gravity=(0.0, 0.0, -9.81))
        self._world.set_num_threads(1)
        self._world.integration_parameters.dt = FRAME
        ground = library.Collider.halfspace((0.0, 0.0, 1.0)).build()
        ball = library.Collider.ball(RADIUS).translation((0.0, 0.0, RADIUS)).build()
        self._world.add_body(library.RigidBody.fixed(), [ground, ball])
        between, edge = SIZE / (side - 1), -0.5 * SIZE
        cloth = library.SoftBody.cloth((edge, edge, HEIGHT), (between, 0.0, 0.0), (0.0, between, 0.0), side, side)
        cloth = cloth.particle_mass(DENSITY * SIZE * SIZE / side**2).particle_radius(0.5 * THICKNESS)
        self._world.add_soft_body(cloth.linear_damping(DAMPING).self_contacts(meets).can_sleep(False))

    def advance(self, frames: int) -> None:
        """Advance by so many frames."""
        for _ in range(frames):
            self._world.step()


class MuJoCo(Draped):
    """MuJoCo's flex of triangles of 200 N/m, by its integrator for them and conjugate gradients, at 2 ms."""

    _ipc = "disable"

    def __init__(self, side: int, meets: bool) -> None:
        if side > _LARGEST:
            raise Missing(f"{side * side * 3} degrees of freedom take seconds for a step")
        library = package("mujoco")
        spacing = SIZE / (side - 1)
        text = f"""<mujoco><option timestep="{_STEP}" integrator="discrete" solver="CG" tolerance="1e-6">
            <flag ipc="{self._ipc}"/></option><size memory="2G"/>
            <worldbody><geom type="plane" size="5 5 0.1"/><geom type="sphere" size="{RADIUS}" pos="0 0 {RADIUS}"/>
            <flexcomp name="cloth" type="grid" dim="2" count="{side} {side} 1" spacing="{spacing} {spacing} {spacing}"
                radius="{0.5 * THICKNESS}" mass="{DENSITY * SIZE * SIZE}" pos="0 0 {HEIGHT}">
            <contact selfcollide="{"auto" if meets else "none"}"/>
            <elasticity young="4e4" poisson="0.1" thickness="{THICKNESS}" damping="0.001" elastic2d="stretch"/>
            </flexcomp></worldbody></mujoco>"""
        self._library, self._model = library, library.MjModel.from_xml_string(text)
        self._data, self._left = library.MjData(self._model), 0.0

    def advance(self, frames: int) -> None:
        """Advance by so many frames, or the steps that come next to them."""
        self._left += frames * FRAME / _STEP
        count = int(self._left)
        self._left -= count
        self._library.mj_step(self._model, self._data, count)


class MuJoCoIPC(MuJoCo):
    """The same with incremental potential contact, an experiment without friction."""

    _ipc = "enable"


class Newton(Draped):
    """Newton's VBD of triangles of 200 N/m, on the processor, as in its example: ten substeps of ten iterations."""

    _hangs = False

    def __init__(self, side: int, meets: bool) -> None:
        if side > _LARGEST:
            raise Missing("it takes seconds for a frame")
        warp, library = package("warp"), package("newton")
        warp.config.log_level = logging.WARNING
        warp.set_device("cpu")
        builder, cells = library.ModelBuilder(), side - 1
        builder.add_ground_plane()
        if not self._hangs:
            place = warp.transform(warp.vec3(0.0, 0.0, RADIUS), warp.quat_identity())
            builder.add_shape_sphere(-1, xform=place, radius=RADIUS)
        builder.add_cloth_grid(
            pos=warp.vec3(-0.5 * SIZE, -0.5 * SIZE, HEIGHT), rot=warp.quat_identity(), vel=warp.vec3(0.0, 0.0, 0.0),
            dim_x=cells, dim_y=cells, cell_x=SIZE / cells, cell_y=SIZE / cells, mass=DENSITY * SIZE * SIZE / side**2,
            fix_left=self._hangs, edge_ke=1e-5, edge_kd=0.0, particle_radius=0.5 * THICKNESS, **self._stiffness(),
        )  # fmt: skip
        builder.color(include_bending=True)
        self._model = builder.finalize()
        self._solver = self._make(library.solvers, meets)
        self._now, self._next = self._model.state(), self._model.state()
        self._control, self._contacts = self._model.control(), self._model.contacts()

    def _stiffness(self) -> dict[str, Any]:
        return {"tri_ke": 200.0, "tri_ka": 200.0, "tri_kd": 0.0}

    def _make(self, solvers: Any, meets: bool) -> Any:
        return solvers.SolverVBD(
            model=self._model, iterations=10, particle_enable_self_contact=meets,
            particle_self_contact_radius=0.5 * THICKNESS, particle_self_contact_margin=THICKNESS,
        )  # fmt: skip

    def advance(self, frames: int) -> None:
        """Advance by so many frames."""
        for _ in range(_NEWTONS_SUBSTEPS * frames):
            self._model.collide(self._now, self._contacts)
            self._now.clear_forces()
            step = FRAME / _NEWTONS_SUBSTEPS
            self._solver.step(self._now, self._next, self._control, self._contacts, step)
            self._now, self._next = self._next, self._now


class NewtonXPBD(Newton):
    """Newton's XPBD of springs, without a ball, on which it is lost: the cloth hangs by one side."""

    _hangs = True

    def __init__(self, side: int, meets: bool) -> None:
        if meets:
            raise Missing("its triangles do not collide with themselves")
        super().__init__(side, meets)

    def _stiffness(self) -> dict[str, Any]:
        return {"add_springs": True, "spring_ke": 200.0, "spring_kd": 0.0}

    def _make(self, solvers: Any, meets: bool) -> Any:
        return solvers.SolverXPBD(model=self._model, iterations=10)


class PyPBD(Draped):
    """pyPBD's XPBD: distances along edges and isometric bending, five substeps, and no ball: the cloth hangs by one side."""

    def __init__(self, side: int, meets: bool) -> None:
        if meets:
            raise Missing("its triangles do not collide with themselves")
        os.environ.setdefault("OMP_NUM_THREADS", "1")
        library = package("pypbd")
        library.Logger.addConsoleSink(library.LogLevel.ERR)
        self._simulation = library.Simulation.getCurrent()  # there is one
        self._simulation.initDefault()
        self._model = model = self._simulation.getModel()
        cloth = model.addRegularTriangleModel(side, side, np.zeros(3), np.identity(3), np.array([SIZE, SIZE]))
        particles = model.getParticles()
        for k in range(side * side):
            particles.setMass(k, 0.0 if k < side else DENSITY * SIZE * SIZE / side**2)
        model.addClothConstraints(cloth, 4, 1e5, 1.0, 1.0, 1.0, 0.3, 0.3, False, False)
        model.addBendingConstraints(cloth, 3, 1e-5)
        model.initConstraintGroups()
        library.TimeManager.getCurrent().setTimeStepSize(FRAME)
        self._simulation.getTimeStep().setValueUInt(library.TimeStepController.NUM_SUB_STEPS, _SUBSTEPS)

    def advance(self, frames: int) -> None:
        """Advance by so many frames."""
        step = self._simulation.getTimeStep()
        for _ in range(frames):
            step.step(self._model)
