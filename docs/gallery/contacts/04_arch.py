"""
An arch without mortar
======================

Wedges of stone in a half circle hold each other. An arch stands as long as a line of thrust fits into it, which in a half
circle needs a thickness of 10.75 % of its radius (Milankovitch 1907). This one has 20 %, and stands; one of 8 % falls. At
the start the stones settle by a millimetre and are then pushed out of their overlaps: hence the first change of the energy.
"""

import numpy as np

import kickdrift as kd


def arch(thickness, count=15, radius=2.0):
    world = kd.World(substeps=8)
    world.add_plane(friction=0.9)
    inner, outer = radius * (1 - thickness / 2), radius * (1 + thickness / 2)
    for a, b in zip(np.linspace(0, np.pi, count + 1)[:-1], np.linspace(0, np.pi, count + 1)[1:], strict=True):
        corners = [(r * np.cos(t), y, r * np.sin(t)) for r in (inner, outer) for t in (a, b) for y in (-0.3, 0.3)]
        world.add_hull(corners, density=2400.0, friction=0.9)
    crown = 1 + count // 2 + 1
    recording = world.run(duration=4.0, step=1 / 120)
    print(
        f"thickness {100 * thickness:.0f} %: "
        f"the crown sank by {1e3 * (recording.x[0, crown, 2] - recording.x[-1, crown, 2]):.1f} mm"
    )
    return recording


figure, fallen = arch(0.20).plot(), arch(0.08).plot()
