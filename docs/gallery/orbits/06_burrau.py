"""
Burrau's three bodies
=====================

Three bodies of masses 3, 4 and 5 begin at rest in the corners of a right-angled triangle (Burrau 1913). They meet again and
again, until at t = 60 the lightest leaves, and the other two go away as a close pair (Szebehely and Peters 1967). Close
passages need short steps, chosen here by an estimate of their error, and each passage magnifies the errors made before it.
"""

import matplotlib.pyplot as plt
import numpy as np

import kickdrift as kd

three = kd.systems.nbody([3, 4, 5], x0=[[1, 3, 0], [-2, -1, 0], [1, -1, 0]], v0=np.zeros((3, 3)))
sol = kd.solve(three, (0.0, 70.0), rtol=1e-13, atol=1e-13, method="dop853")

fig, ax = plt.subplots(figsize=(6.5, 6.5))
for body, mass in enumerate((3, 4, 5)):
    ax.plot(*sol.x[:, body, :2].T, linewidth=0.7, label=f"mass {mass}")
    ax.plot(*sol.x[0, body, :2], "o", color=f"C{body}", markersize=2 + mass)
ax.set(aspect="equal", xlabel="x", ylabel="y", xlim=(-6, 6), ylim=(-7, 8))
ax.legend()
pairs = np.linalg.norm(sol.x[:, [0, 0, 1]] - sol.x[:, [1, 2, 2]], axis=2)
print(f"{sol.n_steps} steps from {sol.step_range[0]:.1e} to {sol.step_range[1]:.1e}; closest passage {pairs.min():.4f}")
print(
    f"distances at t = 70: {np.round(pairs[-1], 1)}; "
    f"the energy, {sol.energy[0]:.3f}, is off by {abs(sol.energy[-1] - sol.energy[0]):.0e}"
)
