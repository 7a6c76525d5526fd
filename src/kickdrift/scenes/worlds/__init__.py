"""Worlds to begin with: stacks, chains, balls, humanoids, robots, cloths, ropes and soft bodies."""

from kickdrift.scenes.worlds.balls import bouncing_disk, newtons_cradle
from kickdrift.scenes.worlds.chains import chain, joint_grid
from kickdrift.scenes.worlds.cloths import drape, flag, net, tear, trampoline
from kickdrift.scenes.worlds.humanoids import add_person, humanoid, ragdolls
from kickdrift.scenes.worlds.moved_cloths import cape, curtain, tablecloth
from kickdrift.scenes.worlds.robots import arm, quadruped, two_link_arm
from kickdrift.scenes.worlds.ropes import bridge, tetherball
from kickdrift.scenes.worlds.soft_bodies import jelly
from kickdrift.scenes.worlds.stacks import dominoes, pile, pyramid

__all__ = [
    "add_person",
    "arm",
    "bouncing_disk",
    "bridge",
    "cape",
    "chain",
    "curtain",
    "dominoes",
    "drape",
    "flag",
    "humanoid",
    "jelly",
    "joint_grid",
    "net",
    "newtons_cradle",
    "pile",
    "pyramid",
    "quadruped",
    "ragdolls",
    "tablecloth",
    "tear",
    "tetherball",
    "trampoline",
    "two_link_arm",
]
