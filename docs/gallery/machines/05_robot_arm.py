"""
A robot arm draws a circle
==========================

Springs with dampers drive two hinges, and their targets follow the inverse kinematics of a circle. The tip is off by what the
springs deflect under the arm's weight; stiffer springs follow more closely, and any stiffness is stable.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

links = (0.5, 0.4)
fig, ax = plt.subplots(figsize=(5.5, 5))
for stiffness in (200, 1000, 5000):
    world = kd.World()
    upper = world.add_capsule(0.04, links[0] - 0.08, position=(0, 0, 1 - links[0] / 2), mass=3.0, collides_with=())
    lower = world.add_capsule(
        0.03, links[1] - 0.06, position=(0, 0, 1 - links[0] - links[1] / 2), mass=1.5, collides_with=()
    )
    shoulder = world.add_hinge(None, upper, anchor=(0, 0, 1), axis=(0, -1, 0))
    elbow = world.add_hinge(upper, lower, anchor=(0, 0, 1 - links[0]), axis=(0, -1, 0))
    way, wanted, last = [], [], None
    while world.time < 6.0:
        turn = np.pi * world.time
        x, z = 0.45 + 0.15 * np.cos(turn), -0.35 + 0.15 * np.sin(turn)  # from the shoulder
        bend = np.arccos((x * x + z * z - links[0] ** 2 - links[1] ** 2) / (2 * links[0] * links[1]))
        first = np.arctan2(x, -z) - np.arctan2(links[1] * np.sin(bend), links[0] + links[1] * np.cos(bend))
        speeds = (0.0, 0.0) if last is None else (200 * (first - last[0]), 200 * (bend - last[1]))
        last = first, bend
        for joint, target, speed in zip((shoulder, elbow), last, speeds, strict=True):
            joint.set_drive(kd.Drive(stiffness=stiffness, damping=0.05 * stiffness, target=target, speed=speed))
        world.step(1 / 200)
        a, b = shoulder.angle, shoulder.angle + elbow.angle
        way.append((links[0] * np.sin(a) + links[1] * np.sin(b), -links[0] * np.cos(a) - links[1] * np.cos(b)))
        wanted.append((x, z))
    way, wanted = np.array(way), np.array(wanted)
    ax.plot(*way[400:].T, label=f"{stiffness} N m/rad")
    print(f"{stiffness} N m/rad: {1e3 * np.linalg.norm(way - wanted, axis=1)[400:].max():.1f} mm off at most")
ax.plot(*wanted[400:].T, "k:", label="target")
ax.set(aspect="equal", xlabel="x (m)", ylabel="z (m)")
ax.legend(fontsize=8)
