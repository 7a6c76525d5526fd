"""The scenes by name, and how they are run by default."""

from collections.abc import Callable
from dataclasses import dataclass

from kickdrift.scenes.worlds.balls import bouncing_disk, newtons_cradle
from kickdrift.scenes.worlds.chains import chain, joint_grid
from kickdrift.scenes.worlds.cloths import drape, flag, net, tear, trampoline
from kickdrift.scenes.worlds.humanoids import humanoid, ragdolls
from kickdrift.scenes.worlds.moved_cloths import cape, curtain, tablecloth
from kickdrift.scenes.worlds.robots import arm, quadruped, two_link_arm
from kickdrift.scenes.worlds.ropes import bridge, tetherball
from kickdrift.scenes.worlds.soft_bodies import jelly
from kickdrift.scenes.worlds.stacks import dominoes, pile, pyramid
from kickdrift.world.world import World


@dataclass(frozen=True)
class Scene:
    """A scene by its name.

    Attributes
    ----------
    make : callable
        Makes its world.
    duration, step : float
        Of a run, s.
    what : str
        What is shown.
    """

    make: Callable[[], World]
    duration: float
    step: float
    what: str


SCENES: dict[str, Scene] = {
    "pyramid": Scene(pyramid, 5.0, 1 / 60, "55 cubes stand on each other in a pyramid"),
    "pile": Scene(lambda: pile(count=(8, 8, 16), spacing=1.8, turn=6.0), 7.0, 1 / 60, "1024 cubes fall into a heap"),
    "dominoes": Scene(dominoes, 3.0, 1 / 240, "30 dominoes fall over"),
    "bouncing-disk": Scene(bouncing_disk, 8.0, 1 / 100, "a ball bounces, lower each time"),
    "cradle": Scene(lambda: newtons_cradle().world, 6.0, 1 / 240, "five balls on strings pass on an impact"),
    "ragdolls": Scene(ragdolls, 4.0, 1 / 60, "16 limp humanoids fall onto each other"),
    "humanoid": Scene(lambda: humanoid().world, 5.0, 1 / 200, "a person stands, held up by springs in the joints"),
    "chain": Scene(lambda: chain().world, 6.0, 1 / 120, "20 rods swing a ball of 1000 times the mass"),
    "joint-grid": Scene(joint_grid, 4.0, 1 / 60, "900 balls, joined into a net, swing"),
    "robot-arm": Scene(lambda: arm(damping=0.4).world, 3.0, 1 / 200, "an arm of seven hinges bends"),
    "two-link-arm": Scene(lambda: two_link_arm().world, 10.0, 1 / 200, "two rods swing without friction"),
    "quadruped": Scene(lambda: quadruped().world, 3.0, 1 / 200, "a robot stands on four legs"),
    "drape": Scene(drape, 3.0, 1 / 60, "a cloth falls over a ball"),
    "flag": Scene(flag, 4.0, 1 / 60, "a flag flutters in the wind"),
    "gusts": Scene(lambda: flag(wind=8.0, gustiness=0.35), 6.0, 1 / 60, "a flag flutters in gusts"),
    "curtain": Scene(curtain, 6.5, 1 / 60, "a pleated curtain is opened and closed"),
    "tablecloth": Scene(tablecloth, 4.0, 1 / 60, "a tablecloth is pulled from under plates and glasses"),
    "cape": Scene(cape, 5.0, 1 / 60, "a person walks with a cape"),
    "net": Scene(net, 4.0, 1 / 60, "a net catches boxes"),
    "tear": Scene(tear, 1.2, 1 / 120, "a ball tears through a sheet"),
    "bridge": Scene(bridge, 5.0, 1 / 60, "crates fall onto a bridge that hangs on ropes"),
    "tetherball": Scene(tetherball, 6.0, 1 / 60, "a ball winds its rope round a pole"),
    "jelly": Scene(jelly, 4.0, 1 / 60, "cubes of jelly and a box fall onto each other"),
    "trampoline": Scene(trampoline, 4.0, 1 / 60, "two balls bounce on a trampoline"),
}
