"""Random sheets that crumple on balls, boxes and edges, or are folded and wound up: nothing may pass through itself.

``python tests/random_sheets.py --seeds 40`` runs them and reports how many pairs of an edge and a triangle cross.
"""

import argparse
import sys
import time

import numpy as np

import kickdrift as kd
from kickdrift.world.deformables.mesh import grid
from kickdrift.world.shapes.mass_properties import rotation_matrix

STEP, LOOK = 1 / 60, 10  # s, and steps between two counts of crossings


def random_sheet(seed):
    """Return a world with one sheet that collides with itself, and the sheet."""
    rng = np.random.default_rng(seed)
    world = kd.World()
    world.add_plane(friction=rng.uniform(0, 1))
    size = 10 ** rng.uniform(-0.5, 0.3)
    add_obstacles(rng, world, size)
    shape, sides = rng.integers(12, 28, 2), size * rng.uniform(0.6, 1.2, 2)
    vertices, triangles = grid(*shape, sides)
    if rng.random() < 0.5:  # triangles of all shapes
        flat = vertices[:, :2]
        inside = ((flat > 0) & (flat < sides)).all(axis=1)
        flat[inside] += rng.uniform(-0.2, 0.2, (inside.sum(), 2)) * sides / (shape - 1)
    turn = rng.normal(size=4) * [1.0, *3 * [rng.choice([0.02, 0.3, 1.0])]]
    place = size * np.array([*rng.uniform(-0.2, 0.2, 2), rng.uniform(0.9, 1.2)])
    sheet = world.add_cloth(
        (vertices - vertices.mean(axis=0)) @ rotation_matrix(turn / np.linalg.norm(turn)).T + place, triangles,
        density=10 ** rng.uniform(-1.5, 0), thickness=size / 20 * rng.uniform(0.05, 0.4),
        bending_stiffness=10 ** rng.uniform(-6, -3), damping=1e-3, linear_damping=rng.uniform(0, 0.5),
        friction=rng.uniform(0, 0.8), self_collision=True,
    )  # fmt: skip
    sheet.velocity[:] = 0.01 * rng.normal(size=sheet.velocity.shape)  # rounding errors let triangles in one plane cross
    x = sheet.position - sheet.position.mean(axis=0)
    if rng.random() < 0.5:  # it is wound up as it falls
        sheet.velocity[:] += np.cross(rng.normal(size=3) * rng.choice([0, 3, 10]), x)
        sheet.velocity[:, 2] += rng.uniform(0, 2) * np.sin(2 * np.pi * rng.uniform(0.5, 2) * x[:, 0] / size)
    return world, sheet


def add_obstacles(rng, world, size):
    """Add a static ball, box, edge or crowd of pegs below a sheet of a size, m."""
    surface = {"static": True, "friction": rng.uniform(0, 1)}
    match rng.integers(5):
        case 0:
            world.add_sphere(0.3 * size, position=(0, 0, 0.35 * size), **surface)
        case 1:
            world.add_box((0.5 * size, 0.3 * size, 0.4 * size), position=(0, 0, 0.25 * size), **surface)
        case 2:
            world.add_box((2 * size, 0.05 * size, 0.7 * size), position=(0, 0, 0.36 * size), **surface)
        case 3:
            for at in rng.uniform(-0.4, 0.4, (4, 2)):
                world.add_capsule(0.06 * size, 0.5 * size, position=(*(size * at), 0.3 * size), **surface)


def crossings(*cloths):
    """How many pairs of an edge and a triangle cross, by brute force: of one cloth, or of several those of different ones."""
    begins = np.cumsum([0, *(len(cloth.position) for cloth in cloths)])
    x = np.concatenate([cloth.position for cloth in cloths])
    faces = np.concatenate([cloth.triangles + begin for cloth, begin in zip(cloths, begins, strict=False)])
    edges = np.unique(np.sort(np.concatenate((faces[:, :2], faces[:, 1:], faces[:, ::2])), axis=1), axis=0)
    a, b, c = (x[faces[:, k]] for k in range(3))
    above = ((x[:, None] - a) * np.cross(b - a, c - a)).sum(axis=2)  # which side of a triangle a particle is on
    edge, face = np.nonzero(above[edges[:, 0]] * above[edges[:, 1]] < 0.0)
    i, j = edges[edge].T
    u, v, w = (corners[face] - x[i] for corners in (a, b, c))
    sides = np.stack([(np.cross(*two) * (x[j] - x[i])).sum(axis=1) for two in ((v, w), (w, u), (u, v))])
    inside = (sides > 0).all(axis=0) | (sides < 0).all(axis=0)
    apart = ~((faces[face] == i[:, None]) | (faces[face] == j[:, None])).any(axis=1)
    if len(cloths) > 1:
        apart = np.searchsorted(begins, faces[face, 0], side="right") != np.searchsorted(begins, i, side="right")
    return int((inside & apart).sum())


def crossed(world, sheet, steps):
    """Return the largest number of crossings in a run, the step at which it was first not zero, and the last number."""
    most, first, count = 0, 0, 0
    for done in range(LOOK, steps + 1, LOOK):
        world.advance(STEP, LOOK)
        count = crossings(sheet)
        first = first or (done if count else 0)
        most = max(most, count)
    return most, first, count


def main():
    """Print a table, and return how many sheets crossed themselves."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--steps", type=int, default=120)
    arguments = parser.parse_args()
    print("| seed | particles | most crossings | first in step | at the end | s |")
    print("| --- | --- | --- | --- | --- | --- |")
    failed = 0
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        world, sheet = random_sheet(seed)
        began = time.perf_counter()
        most, first, last = crossed(world, sheet, arguments.steps)
        failed += most > 0
        spent = time.perf_counter() - began
        print(f"| {seed} | {len(sheet.position)} | {most} | {first} | {last} | {spent:.1f} |", flush=True)
    print(f"\n{failed} of {arguments.seeds} sheets crossed themselves")
    return failed


if __name__ == "__main__":
    sys.exit(main() > 0)
