"""
What accuracy costs
===================

Kepler's ellipse, nearly ten times around, by methods of kicks and drifts of orders 1 to 10, and by DOP853. With 48,000
evaluations of the force, the semi-implicit Euler method (``kick-drift``) has two correct digits, Verlet's four, and Blanes
and Moan's of order four eleven.
"""

import kickdrift as kd

orbit = kd.systems.kepler(eccentricity=0.3)
names = [
    "semi-implicit-euler",
    "velocity-verlet",
    "blanes-moan-srkn6b",
    "blanes-moan-srkn11b",
    "kahan-li-8",
    "sofroniou-spaletta-10",
    "dop853",
]
costs = {
    "semi-implicit-euler": 1,
    "velocity-verlet": 1,
    "blanes-moan-srkn6b": 6,
    "blanes-moan-srkn11b": 11,
    "kahan-li-8": 17,
    "sofroniou-spaletta-10": 35,
    "dop853": 12,
}
steps = {name: [costs[name] * 60 / n for n in (1500, 3000, 6000, 12_000, 24_000, 48_000)] for name in names}
measured = kd.analysis.work_precision(orbit, (0.0, 60.0), names, steps, rounds=15)
figure = measured.plot()
for curve in measured.curves:
    best = curve.errors.argmin()
    print(f"{curve.label:22} error {curve.errors[best]:.1e} for {curve.evaluations[best]:.0f} evaluations")
