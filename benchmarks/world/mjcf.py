"""A scene as MuJoCo's XML: joints that make trees in the coordinates of the joints, others as constraints."""

from dataclasses import replace

import numpy as np

from benchmarks.world.described import (
    GROUND,
    Body,
    Branch,
    Floats,
    Joint,
    Scene,
    Unsupported,
    branches,
    inverse,
    rotation,
    times,
)

_HEAVY = 1e9  # kg: of a plate that runs like a belt, so that nothing on it slows it down
_ON_AXIS = 0.1  # m: where the points of a hinge that closes a loop lie


def text(
    scene: Scene, step: float, free: bool = False, solver: str = "Newton", integrator: str = "implicitfast"
) -> str:
    """Write a scene as MJCF.

    Parameters
    ----------
    scene : Scene
    step : float
        Seconds.
    free : bool
        Whether to leave the joints out, so that every body moves on its own; what they join still does not collide.
    solver, integrator : str
        As MuJoCo calls them.
    """
    if free:
        still = [body if body.mass > 0 else replace(body, velocity=np.zeros(3), belt=None) for body in scene.bodies]
        scene = replace(scene, bodies=still, planar=False)
        found, closing = [Branch(i, GROUND, None) for i in range(len(scene.bodies))], []
    else:
        _check(scene)
        found, closing = branches(scene)
    joined = [(_name(joint.a), _name(joint.b)) for joint in scene.joints if GROUND not in (joint.a, joint.b)]
    lines = [
        f'<mujoco><option timestep="{step!r}" integrator="{integrator}" solver="{solver}"',
        f'gravity="{_row(scene.gravity)}"><flag autoreset="disable"/></option>',
        '<compiler angle="radian" autolimits="true"/><size memory="4G"/><asset>',
        *(_mesh(number, body) for number, body in enumerate(scene.bodies) if body.kind == "hull"),
        "</asset><worldbody>",
        *_nested(scene, found),
        "</worldbody><equality>",
        *(line for joint in closing for line in _closing(scene, joint)),
        "</equality><contact>",
        *(f'<exclude body1="{a}" body2="{b}"/>' for a, b in joined),
        *(_friction_pairs(scene) if not free else ()),
        "</contact><actuator>",
        *(_actuator(_name(body), joint) for body, joint in driven_hinges(found)),
        "</actuator></mujoco>",
    ]
    return "\n".join(lines)


def _check(scene: Scene) -> None:
    if any(body.restitution > 0 for body in scene.bodies):
        raise Unsupported("a coefficient of restitution")
    if any(joint.motor for joint in scene.joints):
        raise Unsupported("a motor that is at its speed or at its maximum: actuators are gains")


def _nested(scene: Scene, found: list[Branch]) -> list[str]:
    children: dict[int, list[Branch]] = {}
    for branch in found:
        children.setdefault(branch.parent, []).append(branch)
    lines = []
    waiting: list[Branch | str] = list(reversed(children.get(GROUND, ())))
    while waiting:
        next_ = waiting.pop()
        if isinstance(next_, str):
            lines.append(next_)
            continue
        lines += [*_opening(scene, next_), _geometry(next_.body, scene.bodies[next_.body])]
        waiting.append("</body>")
        waiting += reversed(children.get(next_.body, ()))
    return lines


def _opening(scene: Scene, branch: Branch) -> list[str]:
    body = scene.bodies[branch.body]
    position, orientation = body.position, body.orientation
    if branch.parent != GROUND:
        parent = scene.bodies[branch.parent]
        back = inverse(parent.orientation)
        position, orientation = rotation(back) @ (position - parent.position), times(back, orientation)
    lines = [f'<body name="{_name(branch.body)}" pos="{_row(position)}" quat="{_row(orientation)}">']
    if body.mass > 0:
        lines.append(f'<inertial pos="0 0 0" mass="{body.mass!r}" diaginertia="{_row(body.inertia)}"/>')
        lines += _free(scene, body) if branch.joint is None else [_joint(scene, branch.body, branch.joint)]
    elif np.any(running(body)):
        lines.append(f'<inertial pos="0 0 0" mass="{_HEAVY!r}" diaginertia="{_HEAVY!r} {_HEAVY!r} {_HEAVY!r}"/>')
        lines.append(f'<joint type="slide" axis="{_row(_own(body, running(body)))}"/>')
    return lines


def _free(scene: Scene, body: Body) -> list[str]:
    if not scene.planar:
        return ["<freejoint/>"]
    kinds = (("slide", (1.0, 0.0, 0.0)), ("slide", (0.0, 0.0, 1.0)), ("hinge", (0.0, 1.0, 0.0)))
    return [f'<joint type="{kind}" axis="{_row(_own(body, np.array(axis)))}"/>' for kind, axis in kinds]


def _own(body: Body, vector: Floats) -> Floats:
    return rotation(inverse(body.orientation)) @ vector


def _joint(scene: Scene, body: int, joint: Joint) -> str:
    if joint.kind == "fixed":
        return ""  # a body without joints is part of its parent
    at = _row(_inside(scene, body, joint.anchor))
    if joint.kind == "ball":
        spring = f'stiffness="{joint.stiffness!r}" damping="{joint.damping!r}"'
        return f'<joint type="ball" name="{_name(body)}" pos="{at}" {spring}/>'
    sign = 1.0 if joint.b == body else -1.0  # an angle of b from a
    numbers = {"axis": _row(_own(scene.bodies[body], sign * joint.axis)), "frictionloss": repr(joint.friction)}
    if joint.limits:
        numbers["range"] = _row(np.array(joint.limits))
    if joint.kind == "slider" and joint.driven:
        numbers |= {"stiffness": repr(joint.stiffness), "springref": repr(sign * joint.target)}
    if not joint.driven or joint.kind == "slider":
        numbers["damping"] = repr(joint.damping)
    kind = {"hinge": "hinge", "slider": "slide"}[joint.kind]
    said = " ".join(f'{name}="{number}"' for name, number in numbers.items())
    return f'<joint type="{kind}" name="{_name(body)}" pos="{at}" {said}/>'


def _mesh(number: int, body: Body) -> str:
    assert body.points is not None
    return f'<mesh name="m{number}" vertex="{_row(body.points.ravel())}" inertia="convex"/>'


def _geometry(number: int, body: Body) -> str:
    if body.kind == "mesh":
        raise Unsupported("meshes that are not convex")
    if body.kind == "hull":
        shape = f'type="mesh" mesh="m{number}"'
    else:
        shape = f'type="{body.kind}" size="{"5 5 1" if body.kind == "plane" else _row(np.array(body.size))}"'
    bits = f'contype="{body.layer}" conaffinity="{body.mask}"' + (' condim="6"' if body.rolling > 0 else "")
    rolling = body.rolling or 0.0001
    return f'<geom {shape} name="g{number}" friction="{body.friction!r} 0.005 {rolling!r}" {bits}/>'


def _friction_pairs(scene: Scene) -> list[str]:
    """Where bodies differ, name the pairs: MuJoCo would take the larger coefficient, the others the geometric mean."""
    if len({body.friction for body in scene.bodies}) <= 1:
        return []
    joined = {frozenset((joint.a, joint.b)) for joint in scene.joints}
    lines = []
    for a, first in enumerate(scene.bodies):
        for b, second in enumerate(scene.bodies[:a]):
            friction = float(np.sqrt(first.friction * second.friction))
            meet = first.layer & second.mask or second.layer & first.mask
            if first.mass == second.mass == 0 or not meet or frozenset((a, b)) in joined:
                continue
            numbers = f"{friction!r} {friction!r} 0.005 0.0001 0.0001"
            lines.append(f'<pair geom1="g{b}" geom2="g{a}" friction="{numbers}"/>')
    return lines


def _closing(scene: Scene, joint: Joint) -> list[str]:
    """Close a loop: a ball by a point, a hinge by two on its axis, which are one in a plane."""
    first, second = (joint.b, joint.a) if joint.b != GROUND else (joint.a, joint.b)
    ends = f'body1="{_name(first)}" body2="{_name(second)}"'
    if joint.kind == "fixed":
        return [f"<weld {ends}/>"]
    if joint.kind not in ("ball", "hinge"):
        raise Unsupported(f"a {joint.kind} that closes a loop")
    points = [joint.anchor]
    if joint.kind == "hinge" and not scene.planar:
        points = [joint.anchor - _ON_AXIS * joint.axis, joint.anchor + _ON_AXIS * joint.axis]
    return [f'<connect {ends} anchor="{_row(_inside(scene, first, point))}"/>' for point in points]


def running(body: Body) -> Floats:
    """Velocity of a body that nothing moves, or of its surface, in the world."""
    return body.velocity if body.belt is None else rotation(body.orientation) @ body.belt


def speed(scene: Scene, branch: Branch) -> Floats:
    """Rates of the coordinates in which a body begins to move, from its velocities and those of its parent."""
    body, joint = scene.bodies[branch.body], branch.joint
    if body.mass == 0:
        return np.array([np.linalg.norm(running(body))])
    if joint is None and scene.planar:
        return np.array([body.velocity[0], body.velocity[2], body.angular_velocity[1]])
    turn = rotation(body.orientation).T
    if joint is None:
        return np.concatenate((body.velocity, turn @ body.angular_velocity))
    parent = None if branch.parent == GROUND else scene.bodies[branch.parent]
    spin = body.angular_velocity - (0.0 if parent is None else parent.angular_velocity)
    if joint.kind == "ball":
        return turn @ spin
    sign = 1.0 if joint.b == branch.body else -1.0
    if joint.kind == "hinge":
        return np.array([sign * joint.axis @ spin])
    return np.array([sign * joint.axis @ (body.velocity - (0.0 if parent is None else parent.velocity))])


def driven_hinges(found: list[Branch]) -> list[tuple[int, Joint]]:
    """Bodies and joints of the actuators, in their order; the springs of balls and sliders are passive ones."""
    joints = [(branch.body, branch.joint) for branch in found if branch.joint is not None]
    return [(body, joint) for body, joint in joints if joint.driven and joint.kind == "hinge"]


def _actuator(name: str, joint: Joint) -> str:
    return f'<position joint="{name}" kp="{joint.stiffness!r}" kv="{joint.damping!r}"/>'


def _inside(scene: Scene, body: int, point: Floats) -> Floats:
    return rotation(inverse(scene.bodies[body].orientation)) @ (point - scene.bodies[body].position)


def _name(body: int) -> str:
    return "world" if body == GROUND else f"b{body}"


def _row(numbers: Floats) -> str:
    return " ".join(repr(float(number)) for number in numbers)
