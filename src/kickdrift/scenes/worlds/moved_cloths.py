"""Cloths that something moves: a curtain, a tablecloth and a cape."""

import math

import numpy as np

from kickdrift.scenes.worlds.humanoids import PELVIS, add_person
from kickdrift.world.deformables.gusts import gusts
from kickdrift.world.deformables.mesh import grid
from kickdrift.world.joints.limits_motors_options import Drive
from kickdrift.world.world import World


def curtain(*, pleats: int = 8, per_pleat: int = 8, rows: int = 22) -> World:
    """Open a pleated curtain, and close it again.

    It hangs from a rod by rings, one per pleat, which springs pull into place: a force that changes with time moves the ends
    of the springs.

    Parameters
    ----------
    pleats : int
    per_pleat, rows : int
        Vertices of a pleat, and from top to bottom.
    """
    width, height, top, depth = 0.25 * pleats, 1.7, 1.9, 0.05
    world = World()
    world.add_plane()
    along = pleats * per_pleat + 1
    points, triangles = grid(along, rows, (width, height))
    waves = depth * np.sin(2.0 * math.pi * points[:, 0] * pleats / width + 0.5 * math.pi)
    hung = np.stack((points[:, 0] - 0.5 * width, waves, points[:, 1] + top - height), axis=1)
    cloth = world.add_cloth(
        hung, triangles, density=0.25, thickness=0.008, bending_stiffness=2e-4, damping=2e-3, linear_damping=0.5, drag=0.5,
        self_collision=True, name="curtain",
    )  # fmt: skip
    world.add_capsule(
        0.012, 1.1 * width, position=(0, depth, top + 0.02), orientation=(math.sqrt(0.5), 0, math.sqrt(0.5), 0), static=True,
        collides_with=(),
    )  # fmt: skip
    stiffness, damping, rings, ways = 400.0, 20.0, [], []
    for pleat in range(pleats + 1):
        held = pleat * per_pleat * rows + rows - 1
        ring = world.add_sphere(0.02, position=cloth.position[held] + (0, 0, 0.02), mass=0.1, collides_with=())
        world.add_slider(None, ring, anchor=ring.position, axis=(1, 0, 0), drive=Drive(stiffness, damping))
        cloth.pin([held], ring)
        rings.append(ring.index)
        ways.append(0.055 * pleat - width * pleat / pleats)
    bodies, way = np.array(rings), np.array(ways)

    def pull(t, force):  # type: ignore[no-untyped-def]
        opening = min(max((t - 0.5) / 2.0, 0.0), 1.0) - min(max((t - 3.5) / 2.0, 0.0), 1.0)
        part = 0.5 - 0.5 * math.cos(math.pi * opening)
        for k in range(len(bodies)):
            force[bodies[k], 0] += stiffness * part * way[k]

    world.add_force(pull)
    return world


def tablecloth(*, vertices: tuple[int, int] = (46, 34), acceleration: float = 15.0) -> World:
    """Pull a tablecloth off a table from under plates and glasses, which stay.

    Parameters
    ----------
    vertices : tuple of int
        Along the pull, and across.
    acceleration : float
        Of the bar that holds its hem, and pulls it from 1.5 s on, m/s^2.
    """
    world = World()
    world.add_plane()
    top = 0.75
    thick = 0.05
    world.add_box((1.2, 0.8, thick), position=(0, 0, top - 0.5 * thick), friction=0.2, static=True)
    for x in (-0.45, 0.45):
        for y in (-0.25, 0.25):
            world.add_box((0.06, 0.06, top - thick), position=(x, y, 0.5 * (top - thick)), static=True)
    # Little hangs over the back: a hem that is pulled over the edge fast flies up, and catches plates.
    cloth = world.add_cloth_grid(
        (1.7, 1.3), vertices, position=(0.25, 0, top + 0.006), density=0.2, thickness=0.01,
        stretch_stiffness=800.0, shear_stiffness=150.0, bending_stiffness=5e-5, damping=2e-3, linear_damping=0.3,
        friction=0.15, drag=0.5, self_collision=True, name="tablecloth",
    )  # fmt: skip
    for x in (-0.3, 0.0, 0.3):
        for y in (-0.2, 0.2):
            world.add_cylinder(0.1, 0.02, position=(x, y, top + 0.022), mass=0.4, friction=0.1)
    for x in (-0.15, 0.15):
        world.add_cylinder(0.03, 0.12, position=(x, 0, top + 0.072), mass=0.3, friction=0.1)
    hem = np.flatnonzero(cloth.position[:, 0] > cloth.position[:, 0].max() - 1e-6)
    bar = world.add_capsule(
        0.012, 1.3, position=cloth.position[hem].mean(axis=0), orientation=(math.sqrt(0.5), math.sqrt(0.5), 0, 0), mass=1.0,
        collides_with=(),
    )  # fmt: skip
    stiffness, damping = 4000.0, 100.0
    world.add_slider(None, bar, anchor=bar.position, axis=(1, 0, 0), drive=Drive(stiffness, damping))
    cloth.pin(hem, bar)
    row, way = bar.index, 1.6

    def pull(t, force):  # type: ignore[no-untyped-def]
        since = min(max(t - 1.5, 0.0), math.sqrt(2.0 * way / acceleration))
        speed = acceleration * since if 0.5 * acceleration * since * since < 0.999 * way else 0.0
        force[row, 0] += stiffness * 0.5 * acceleration * since * since + damping * speed

    world.add_force(pull)
    return world


def cape(*, vertices: tuple[int, int] = (20, 26), speed: float = 1.4) -> World:
    """Let a person walk with a cape.

    The person is led along a rail. The springs in the joints follow angles that swing with the steps: torques on both sides
    of a joint move the ends of its spring.

    Parameters
    ----------
    vertices : tuple of int
        Of the cape, from side to side and from top to bottom.
    speed : float
        Of the walk, m/s.
    """
    world = World()
    world.add_plane(friction=0.2)
    stiffness, damping = 600.0, 25.0
    lifted = 0.003
    person = add_person(world, position=(0, 0, PELVIS + lifted), drive=Drive(stiffness, damping))
    lead, follow = 20000.0, 2000.0
    world.add_slider(
        None, person["pelvis"], anchor=person["pelvis"].position, axis=(1, 0, 0), drive=Drive(lead, follow)
    )
    points, triangles = grid(*vertices, (0.75, 1.15))
    round_, down = (points[:, 0] - 0.375) / 0.375, points[:, 1]
    flare = 1.0 + 0.5 * (1.15 - down) / 1.15
    hung = np.stack(
        (-0.17 - 0.06 * (1.15 - down) + 0.07 * np.abs(round_) ** 2, 0.29 * round_ * flare, 0.33 + lifted + down), axis=1
    )
    cloth = world.add_cloth(
        hung, triangles[:, ::-1], warp=(0, 1, 0), density=0.5, thickness=0.01, bending_stiffness=1e-4, damping=2e-3, drag=1.2,
        lift=0.5, friction=0.3, self_collision=True, name="cape",
    )  # fmt: skip
    shoulders = np.flatnonzero((points[:, 1] > 1.149) & (np.abs(round_) < 0.75))
    cloth.pin(shoulders, person["chest"])
    world.add_wind(gusts((-0.4, 0.2, 0.0), intensity=0.5, length=2.0, seed=4))
    pelvis = person["pelvis"].index
    swung = [  # child, parent, swing, phase, and bend of each joint, rad
        ("thigh", "pelvis", 0.45, 0.0, 0.0),
        ("shin", "thigh", 0.0, 0.0, 0.9),
        ("upper arm", "chest", -0.4, 0.0, 0.0),
        ("forearm", "upper arm", 0.0, 0.0, -0.35),
    ]
    pairs, angles = [], []
    for side, phase in (("left", 0.0), ("right", math.pi)):
        for child, parent, swing, lag, bend in swung:
            of = parent if parent in ("pelvis", "chest") else f"{side} {parent}"
            pairs.append((person[f"{side} {child}"].index, person[of].index))
            angles.append((swing, phase + lag, bend))
    limbs, motion, rate = np.array(pairs), np.array(angles), 2.0 * math.pi * 0.9

    def walk(t, force, torque):  # type: ignore[no-untyped-def]
        begun = min(t / 0.5, 1.0)
        way = speed * (t - 0.25) if t > 0.5 else speed * t * t
        force[pelvis, 0] += lead * way + follow * speed * min(t / 0.5, 1.0)
        for k in range(len(limbs)):
            swing, phase, bend = motion[k]
            turn = rate * t + phase
            angle = begun * (-swing * math.sin(turn) + bend * max(math.sin(turn + 0.9), 0.0))
            torque[limbs[k, 0], 1] += stiffness * angle
            torque[limbs[k, 1], 1] -= stiffness * angle

    world.add_force(walk)
    return world
