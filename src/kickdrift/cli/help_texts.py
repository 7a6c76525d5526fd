"""The texts of ``--help``; in a paragraph that begins with a backspace, line breaks are kept."""

SAMPLE_TOML = """\
G = 39.4769264                # gravitational constant (default: 1, without units)
softening = 0.0               # softening length (default: 0)

[units]                       # of all numbers in this file
time = "year"
length = "au"
mass = "solar mass"

[run]                         # defaults for options of the command line
duration = 100.0
step = 0.001
method = "stormer-verlet"
save_every = 100

[[bodies]]
name = "Sun"
mass = 1.0
position = [0.0, 0.0, 0.0]
velocity = [0.0, 0.0, 0.0]

[[bodies]]
name = "Earth"
mass = 3e-6
position = [1.0, 0.0, 0.0]
velocity = [0.0, 6.2831853, 0.0]
"""

SAMPLE_CSV = """\
name,mass,x,y,z,vx,vy,vz
Sun,1.0,0,0,0,0,0,0
Earth,3e-6,1,0,0,0,6.2831853,0
"""

KICKDRIFT = """Structure-preserving integration for mechanics.

\b
  kickdrift run solar-system      a hundred years, compared with JPL's positions
  kickdrift run bodies.toml       bodies of your own
  kickdrift run pyramid           a pyramid of boxes, with a plot and a page for the browser
  kickdrift view ragdolls         a world live in the browser, where the mouse pulls bodies
  kickdrift compare kepler        Euler's methods and Stoermer-Verlet side by side
  kickdrift list methods
  kickdrift compile               compile code in advance, so that runs start at once

Exit codes: 0 success, 2 invalid input, 3 failed run, 130 interrupted.
"""


def _literal(text: str) -> str:
    return "\n\n".join("\b\n" + "\n".join(f"  {line}" for line in part.splitlines()) for part in text.split("\n\n"))


RUN = f"""Run a system or a scene, report on it, and write <name>.npz and <name>.png.

The solar system runs for 100 years by default, and is compared with the positions of JPL's DE421 at times up to ten years
after J2000. Ctrl-C ends a run early, and the states up to that time are written. With --checkpoint the same command resumes an
interrupted run, even if the process was killed. With --save-to the states are written to disk during the run, where
xarray can read them, and the other files are not written.

\b
  kickdrift run solar-system
  kickdrift run solar-system --years 10 --step "0.125 day" --method leapfrog
  kickdrift run solar-system --bodies "Sun,Earth,Jupiter" --output earth
  kickdrift run kepler --duration 1000 --step 0.001
  kickdrift run bodies.toml
  kickdrift run solar-system --years 100000 --checkpoint millennia
  kickdrift run outer-solar-system --save-to planets.zarr --save-every 10

Scenes are worlds of rigid bodies and cloth. With the extra viewer, a run of a scene also writes an interactive
page for the browser, <scene>.html; with --film, an animation, <scene>.gif, in real time, or faster if it would last
more than 20 s; with --contacts, the page shows the points at which bodies press on each other. Scenes take the options
--duration, --step, --save-every, --output, --checkpoint, --save-to, --film, --contacts and --quiet; times are in seconds.

\b
  kickdrift run pyramid
  kickdrift run ragdolls --duration 2 --step 0.01 --output humanoids

A bodies file, such as bodies.toml, has these keys; all but the bodies are optional, and any other key is an error:

{_literal(SAMPLE_TOML)}

With bodies = "bodies.csv" at the top instead of [[bodies]], they are read from that file in the same folder:

{_literal(SAMPLE_CSV)}
"""

VIEW = """Show a scene, a robot or a saved run in the browser (extra viewer).

Scenes, robots (extra robots) and saved worlds run live on a page, in real time if steps are fast enough, with buttons to
play, pause, step and reset, sliders for speed, substeps and the targets of joints, and a spring with which the mouse pulls
bodies. Only this machine can open the page; Ctrl-C ends it. For a saved run, FILE.npz, a page that plays without a server,
FILE.html, is written beside it.

\b
  kickdrift view pyramid
  kickdrift view robot.xml --step 0.002
  kickdrift view world.npz --port 8081
  kickdrift view kickdrift-output/pile.npz
"""

COMPARE = """Run explicit, implicit and semi-implicit Euler and Stoermer-Verlet with the same step.

Prints the largest relative energy error, the energy drift, the cost and, where the exact solution is known, the error
in position at the end; plots the energy errors in <system>-energy.png.

\b
  kickdrift compare kepler
  kickdrift compare pendulum --step 0.2 --duration 500
  kickdrift compare solar-system --years 1 --step "0.01 day"
"""

COMPILE = """Compile the code of worlds, pictures, systems and most methods in advance, on all cores.

It takes minutes, once on a machine. Code that is compiled already is kept. Without this command, each run compiles the code
that it lacks.

\b
  kickdrift compile
"""

LIST = """List the methods, the systems or the scenes; lines are not truncated if the output is piped.

\b
  kickdrift list methods
  kickdrift list systems | grep -w yes
  kickdrift list scenes
"""
