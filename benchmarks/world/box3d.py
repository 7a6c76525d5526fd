"""A scene in Box3D, through robox3d: 32-bit numbers, one object a body."""

from typing import Any

import numpy as np

from benchmarks.peers import package
from benchmarks.world.described import (
    GROUND,
    Body,
    Floats,
    Joint,
    Scene,
    Unsupported,
    inverse,
    rotation,
    shortest_turn,
    times,
)

_UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
_ROOM = 500.0  # half the width of the box that a plane is, m


class Box3d:
    """Box3D with its defaults and four substeps, but that nothing sleeps.

    Parameters
    ----------
    scene : Scene
    step : float
        Seconds.
    """

    def __init__(self, scene: Scene, step: float) -> None:
        self._library = library = package("robox3d")
        self._ffi, self._lib = library._ffi.ffi, library._ffi.lib
        self._scene, self._seconds = scene, step
        self._world = library.World(gravity=tuple(scene.gravity), substeps=4)
        self._meshes: list[Any] = []
        self._bodies = [self._body(body) for body in scene.bodies]
        self._group = library.BodyGroup(self._bodies)
        self._ground = self._world.create_body(kind="static") if scene.joints else None
        for joint in scene.joints:
            self._joint(joint)

    def close(self) -> None:
        """Let go of the memory; there are at most 128 worlds at a time."""
        self._world.destroy()
        for mesh in self._meshes:
            self._lib.b3DestroyMesh(mesh)

    def step(self) -> None:
        """Take a step."""
        self._world.step(self._seconds)

    def advance(self, count: int) -> None:
        """Take so many steps."""
        self._world.step_n(count, self._seconds)

    def push(self, body: int, force: Floats) -> None:
        """Let a force act on a body in the next step."""
        self._bodies[body].apply_force(force)

    def poses(self) -> Floats:
        """Positions and orientations, (N, 7)."""
        return self._group.poses().astype(np.float64)[:, [0, 1, 2, 6, 3, 4, 5]]

    def motions(self) -> Floats:
        """Velocities and angular velocities, (N, 6)."""
        return self._group.velocities().astype(np.float64)

    def _body(self, body: Body) -> Any:
        kind = "dynamic" if body.mass > 0 else "kinematic" if np.any(body.velocity) else "static"
        made = self._world.create_body(body.position, np.roll(body.orientation, -1), kind)
        if self._scene.planar and body.mass > 0:
            locks = {"linearY": True, "angularX": True, "angularZ": True}
            self._lib.b3Body_SetMotionLocks(made.id, self._ffi.new("b3MotionLocks*", locks)[0])
        self._shape(body, made)
        if body.mass > 0:
            made.set_mass_data(body.mass, (0.0, 0.0, 0.0), np.diag(body.inertia))
        if kind != "static":
            made.linear_velocity, made.angular_velocity = body.velocity, body.angular_velocity
        return made

    def _shape(self, body: Body, made: Any) -> None:
        surface = {"friction": body.friction, "restitution": body.restitution}
        if body.kind == "plane":
            shape = made.add_box((_ROOM, _ROOM, 1.0), (0.0, 0.0, -1.0), **surface)
        elif body.kind == "sphere":
            shape = made.add_sphere(body.size[0], **surface)
        elif body.kind == "capsule":
            ends = [(0.0, 0.0, sign * body.size[1]) for sign in (-1, 1)]
            shape = made.add_capsule(*ends, body.size[0], **surface)
        elif body.kind == "box":
            shape = made.add_box(body.size, **surface)
        elif body.kind == "hull":
            shape = made.add_hull(body.points, **surface, max_vertices=64)
        else:
            shape = self._mesh(body, made)
        lib, ffi = self._lib, self._ffi
        filter_ = ffi.new("b3Filter*", {"categoryBits": body.layer, "maskBits": body.mask, "groupIndex": 0})
        lib.b3Shape_SetFilter(shape, filter_[0], False)
        if body.belt is not None or body.rolling > 0:
            material = lib.b3Shape_GetSurfaceMaterial(shape)
            if body.belt is not None:
                material.tangentVelocity = self._vector(body.belt)
            if body.rolling > 0:
                material.rollingResistance = body.rolling / body.size[0]  # times the larger radius
            lib.b3Shape_SetSurfaceMaterial(shape, material)

    def _mesh(self, body: Body, made: Any) -> Any:
        lib, ffi = self._lib, self._ffi
        assert body.points is not None
        assert body.faces is not None
        points = ffi.new("b3Vec3[]", [tuple(map(float, point)) for point in body.points])
        indices = ffi.new("int32_t[]", body.faces.ravel().tolist())
        about = ffi.new("b3MeshDef*")
        about.vertices, about.indices = points, indices
        about.vertexCount, about.triangleCount, about.identifyEdges = len(body.points), len(body.faces), True
        self._meshes.append(lib.b3CreateMesh(about, ffi.NULL, 0))
        shape = lib.b3DefaultShapeDef()
        shape.baseMaterial.friction, shape.baseMaterial.restitution = body.friction, body.restitution
        return lib.b3CreateMeshShape(made.id, ffi.addressof(shape), self._meshes[-1], self._vector((1.0, 1.0, 1.0)))

    def _joint(self, joint: Joint) -> None:
        ends = [self._ground if end == GROUND else self._bodies[end] for end in (joint.a, joint.b)]
        if joint.kind == "ball":
            self._ball(joint, ends)
            return
        if joint.kind == "fixed":
            self._world.create_weld_joint(*ends, joint.anchor, constraint_hertz=None)
            return
        options: dict[str, Any] = {"limits": joint.limits, "constraint_hertz": None}
        if joint.motor is not None:
            options["motor"] = joint.motor[::-1]
        elif joint.friction > 0:
            options["motor"] = (joint.friction, 0.0)
        if joint.driven:
            options["spring"] = self._spring(joint)
            options["target_angle" if joint.kind == "hinge" else "target_translation"] = joint.target
        elif joint.damping > 0:
            raise Unsupported("damping without a spring")
        if joint.kind == "hinge":
            self._world.create_revolute_joint(*ends, joint.anchor, joint.axis, **options)
        else:
            self._slider(joint, ends, options)

    def _slider(self, joint: Joint, ends: list[Any], options: dict[str, Any]) -> None:
        """Slide along x of the frame, as Box3D does; robox3d puts z there and says the same of it."""
        made = self._world.create_prismatic_joint(*ends, joint.anchor, joint.axis, **options)
        turn = shortest_turn(np.array([1.0, 0.0, 0.0]), joint.axis)
        for end, body, place in zip(
            ends, (joint.a, joint.b), (self._lib.b3Joint_SetLocalFrameA, self._lib.b3Joint_SetLocalFrameB), strict=True
        ):
            back = inverse(_UPRIGHT if body == GROUND else self._scene.bodies[body].orientation)
            frame = self._ffi.new("b3Transform*")
            frame.p = self._vector(rotation(back) @ (joint.anchor - end.position))
            frame.q.s, frame.q.v.x, frame.q.v.y, frame.q.v.z = times(back, turn)
            place(made.id, frame[0])

    def _ball(self, joint: Joint, ends: list[Any]) -> None:
        lib = self._lib
        if joint.damping > 0 or joint.friction > 0:
            raise Unsupported("a ball joint that damps")
        about = lib.b3DefaultSphericalJointDef()
        about.base.bodyIdA, about.base.bodyIdB = (end.id for end in ends)
        self._world._set_joint_frames(about.base, *ends, joint.anchor, joint.axis)
        lib.b3CreateSphericalJoint(self._world.id, self._ffi.addressof(about))

    def _spring(self, joint: Joint) -> tuple[float, float]:
        """Frequency and damping ratio, which Box3D takes with the effective mass of the two bodies."""
        response = 0.0
        for end in (joint.a, joint.b):
            if end != GROUND and (body := self._scene.bodies[end]).mass > 0:
                along = rotation(body.orientation).T @ joint.axis
                response += along**2 @ (1 / body.inertia) if joint.kind == "hinge" else 1 / body.mass
        rate = np.sqrt(joint.stiffness * response)
        return rate / (2 * np.pi), joint.damping * response / (2 * rate)

    def _vector(self, v: Any) -> Any:
        return self._ffi.new("b3Vec3*", dict(zip("xyz", map(float, v), strict=True)))[0]
