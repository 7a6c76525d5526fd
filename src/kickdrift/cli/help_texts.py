"""What ``--help`` says; a paragraph that begins with a backspace keeps its lines."""

SAMPLE_TOML = """\
G = 39.4769264                # constant of gravitation (1 where there are no units)
softening = 0.0               # softening length (0)

[units]                       # of all numbers here
time = "year"
length = "au"
mass = "solar mass"

[run]                         # what the command line does not say
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
  kickdrift run pyramid           boxes on boxes, with a picture and a film
  kickdrift view ragdolls         a world that runs in the browser, and is pulled with the mouse
  kickdrift compare kepler        Euler's methods and Stoermer-Verlet side by side
  kickdrift list methods
  kickdrift compile               all that runs may need, once on this machine

Exit codes: 0 done, 2 input that cannot be used, 3 a run that failed on its way, 130 interrupted.
"""


def _literal(text: str) -> str:
    return "\n\n".join("\b\n" + "\n".join(f"  {line}" for line in part.splitlines()) for part in text.split("\n\n"))


RUN = f"""Run a system or a scene, report on it, and write <name>.npz and <name>.png.

The solar system runs for 100 years by default, and is compared with the positions of JPL's DE421 at J2000 and up to
ten years later. Ctrl-C ends a run early; what is done is written. With --checkpoint the same command goes on from where it
was, also after the process was killed. With --save-to the states go to disk as the run goes on, where xarray reads them, and
nothing else is written.

\b
  kickdrift run solar-system
  kickdrift run solar-system --years 10 --step "0.125 day" --method leapfrog
  kickdrift run solar-system --bodies "Sun,Earth,Jupiter" --output earth
  kickdrift run kepler --duration 1000 --step 0.001
  kickdrift run bodies.toml
  kickdrift run solar-system --years 100000 --checkpoint millennia
  kickdrift run outer-solar-system --save-to planets.zarr --save-every 10

Scenes are worlds of bodies that touch, stack, hinge and walk; a film of each is written besides, <scene>.gif, in real
time, or faster if it would take more than 20 s; and with the extra viewer a page for the browser, <scene>.html, in
which it turns under the mouse. Of the options they have --duration, --step, --save-every, --output,
--checkpoint, --save-to and --quiet; times are in seconds.

\b
  kickdrift run pyramid
  kickdrift run ragdolls --duration 2 --step 0.01 --output humanoids

A bodies file, bodies.toml, holds these keys; all but the bodies may be left out, and any other is an error:

{_literal(SAMPLE_TOML)}

With bodies = "bodies.csv" at its top instead, they are read from that file beside it:

{_literal(SAMPLE_CSV)}
"""

VIEW = """Show a scene, a robot or a saved run in the browser (extra viewer).

Scenes, robots (extra robots) and worlds that were saved run on a page, in real time where steps are fast enough: play, pause,
step, reset, speed, sliders for the targets of joints, gravity and substeps, and the mouse pulls at bodies. The page is for this
machine alone, and ends with Ctrl-C. Of a run that was saved, FILE.html is written beside FILE.npz; it plays without a server.

\b
  kickdrift view pyramid
  kickdrift view robot.xml --step 0.002
  kickdrift view world.npz --port 8081
  kickdrift view kickdrift-output/pile.npz
"""

COMPARE = """Run explicit, implicit and semi-implicit Euler and Stoermer-Verlet with the same step.

Shows the largest relative energy error, its drift, what each costs and, where the exact solution is known, the error
in position at the end; draws the energy errors in <system>-energy.png.

\b
  kickdrift compare kepler
  kickdrift compare pendulum --step 0.2 --duration 500
  kickdrift compare solar-system --years 1 --step "0.01 day"
"""

COMPILE = """Compile what worlds, pictures, systems and most methods need, once on this machine, on all cores.

What is compiled already is kept. Without this, each run compiles what it is the first to need.

\b
  kickdrift compile
"""

LIST = """List the methods, the systems or the scenes; whole lines where the output is piped.

\b
  kickdrift list methods
  kickdrift list systems | grep -w yes
  kickdrift list scenes
"""
