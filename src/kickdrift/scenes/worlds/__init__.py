"""Worlds to begin with: stacks, chains, balls, humanoids and robots."""

from kickdrift.scenes.worlds.balls import bouncing_disk, newtons_cradle
from kickdrift.scenes.worlds.chains import chain, joint_grid
from kickdrift.scenes.worlds.humanoids import add_person, humanoid, ragdolls
from kickdrift.scenes.worlds.robots import arm, quadruped, two_link_arm
from kickdrift.scenes.worlds.stacks import dominoes, pile, pyramid

__all__ = [
    "add_person",
    "arm",
    "bouncing_disk",
    "chain",
    "dominoes",
    "humanoid",
    "joint_grid",
    "newtons_cradle",
    "pile",
    "pyramid",
    "quadruped",
    "ragdolls",
    "two_link_arm",
]
