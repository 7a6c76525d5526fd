"""
A walking robot
===============

A trunk and four legs, each with a hip and a knee, driven by springs with dampers whose targets oscillate. Diagonally opposite
legs step together: a trot of 2.5 strides per second. It keeps its balance without feedback.
"""

import numpy as np

import kickdrift as kd

robot = kd.World()
robot.add_plane(friction=0.9)
bend, link = 0.5, 0.25
high = 0.03 + 2 * link * np.cos(bend)
trunk = robot.add_box((0.6, 0.2, 0.12), position=(0, 0, high), mass=10.0)
legs = []
for x in (0.25, -0.25):
    for y in (0.16, -0.16):
        a, b = x - link * np.sin(bend), high - link * np.cos(bend)  # where the knee is
        back, forth = ((np.cos(0.5 * bend), 0, sign * np.sin(0.5 * bend), 0) for sign in (1, -1))
        thigh = robot.add_capsule(0.03, link, position=(0.5 * (x + a), y, 0.5 * (high + b)), orientation=back, mass=1.0)
        shin = robot.add_capsule(0.03, link, position=(0.5 * (x + a), y, 0.5 * (0.03 + b)), orientation=forth, mass=0.5)
        hip = robot.add_hinge(trunk, thigh, anchor=(x, y, high), axis=(0, 1, 0))
        legs.append((hip, robot.add_hinge(thigh, shin, anchor=(a, y, b), axis=(0, 1, 0)), np.pi if x * y > 0 else 0.0))

with robot.record() as walk:
    for _ in range(1000):
        for hip, knee, phase in legs:
            turn = 2 * np.pi * 2.5 * robot.time + phase
            hip.set_drive(kd.Drive(stiffness=300, damping=8, target=-0.12 * np.sin(turn)))
            knee.set_drive(kd.Drive(stiffness=300, damping=8, target=-0.6 * max(0.0, np.cos(turn))))
        robot.step(1 / 200)
figure = walk.plot()
trunk_at = walk.x[:, trunk.index]
print(
    f"{trunk_at[-1, 0]:.2f} m in 5 s, {abs(trunk_at[:, 1]).max():.2f} m to the side, "
    f"the trunk between {trunk_at[200:, 2].min():.3f} and {trunk_at[200:, 2].max():.3f} m high"
)
walk.show()
