"""The worked example of the method: a mass on a spring, x'' = -x, four steps of 0.1, beside the exact motion."""

import math

import kickdrift as kd


def spring(x):
    return -x


def main():
    sol = kd.solve(spring, t_span=(0.0, 0.4), x0=1.0, v0=0.0, method="semi-implicit-euler", step=0.1)
    print("n    t      x_n      v_n    cos t   -sin t  x^2 + v^2")
    for n, (t, x, v) in enumerate(zip(sol.t, sol.x, sol.v, strict=True)):
        print(f"{n}  {t:.1f}  {x:7.4f}  {v:7.4f}  {math.cos(t):7.4f}  {-math.sin(t):7.4f}     {x * x + v * v:.4f}")
    kept = sol.x**2 + sol.v**2 - sol.step * sol.x * sol.v
    print(f"x^2 + v^2 - h x v stays at {kept[0]:.15f} to {abs(kept - kept[0]).max():.0e}")


if __name__ == "__main__":
    main()
