"""A scene as MuJoCo's XML: joints that make trees in the coordinates of the joints, others as constraints."""

import numpy as np

from benchmarks.world.described import GROUND, Body, Branch, Floats, Joint, Scene, branches, inverse, rotation, times


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
        found, closing = [Branch(i, GROUND, None) for i in range(len(scene.bodies))], []
    else:
        found, closing = branches(scene)
    joined = [(_name(joint.a), _name(joint.b)) for joint in scene.joints if GROUND not in (joint.a, joint.b)]
    lines = [
        f'<mujoco><option timestep="{step!r}" integrator="{integrator}" solver="{solver}"',
        f'gravity="{_row(scene.gravity)}"><flag autoreset="disable"/></option>',
        '<compiler angle="radian" autolimits="true"/><size memory="4G"/><worldbody>',
        *_nested(scene, found),
        "</worldbody><equality>",
        *(_closing(scene, joint) for joint in closing),
        "</equality><contact>",
        *(f'<exclude body1="{a}" body2="{b}"/>' for a, b in joined),
        "</contact><actuator>",
        *(_spring(body, joint) for body, joint in driven_hinges(found)),
        "</actuator></mujoco>",
    ]
    return "\n".join(lines)


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
        lines += [*_opening(scene, next_), _geometry(scene.bodies[next_.body])]
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
        lines.append("<freejoint/>" if branch.joint is None else _joint(scene, branch.body, branch.joint))
    return lines


def _joint(scene: Scene, body: int, joint: Joint) -> str:
    at = _row(_inside(scene, body, joint.anchor))
    damping = f' damping="{joint.damping!r}"'
    if joint.kind == "ball":
        return f'<joint type="ball" name="{_name(body)}" pos="{at}" stiffness="{joint.stiffness!r}"{damping}/>'
    sign = 1.0 if joint.b == body else -1.0  # an angle of b from a
    axis = rotation(inverse(scene.bodies[body].orientation)) @ (sign * joint.axis)
    limits = f' range="{_row(np.array(joint.limits))}"' if joint.limits else ""
    return f'<joint type="hinge" name="{_name(body)}" pos="{at}" axis="{_row(axis)}"{limits}{"" if joint.driven else damping}/>'


def _geometry(body: Body) -> str:
    size = "5 5 1" if body.kind == "plane" else _row(np.array(body.size))
    bits = f'contype="{body.layer}" conaffinity="{body.mask}"'
    return f'<geom type="{body.kind}" size="{size}" friction="{body.friction!r} 0.005 0.0001" {bits}/>'


def _closing(scene: Scene, joint: Joint) -> str:
    if joint.kind != "ball":
        raise ValueError(f"A {joint.kind} closes a loop; only balls are known to do so here.")
    at = _row(_inside(scene, joint.b, joint.anchor))
    return f'<connect body1="{_name(joint.b)}" body2="{_name(joint.a)}" anchor="{at}"/>'


def driven_hinges(found: list[Branch]) -> list[tuple[int, Joint]]:
    """Bodies and joints of the actuators, in their order; the springs of balls are passive ones."""
    joints = [(branch.body, branch.joint) for branch in found if branch.joint is not None]
    return [(body, joint) for body, joint in joints if joint.driven and joint.kind == "hinge"]


def _spring(body: int, joint: Joint) -> str:
    return f'<position joint="{_name(body)}" kp="{joint.stiffness!r}" kv="{joint.damping!r}"/>'


def _inside(scene: Scene, body: int, point: Floats) -> Floats:
    return rotation(inverse(scene.bodies[body].orientation)) @ (point - scene.bodies[body].position)


def _name(body: int) -> str:
    return "world" if body == GROUND else f"b{body}"


def _row(numbers: Floats) -> str:
    return " ".join(repr(float(number)) for number in numbers)
