"""Stacks of boxes drawn at random, which exact statics holds, and chimneys of rings of blocks."""

from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from benchmarks.lab.building import GRAVITY, GROUND, Builder
from benchmarks.lab.measures import rests, sinks, stays
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Floats, Scene

_INWARDS = 0.12  # by which part of a shared face the forces lie inside of its edges
_APART = 0.03  # m, between faces that do not touch
_SAME = 1e-9  # m
_BALANCED = 1e-8  # of the largest weight, which rounding may leave


class _Box(NamedTuple):
    """An upright box: centre and edges, (3,), m, and mass, kg."""

    centre: Floats
    edges: Floats
    mass: float

    @property
    def low(self) -> Floats:
        return self.centre - self.edges / 2

    @property
    def high(self) -> Floats:
        return self.centre + self.edges / 2

    @property
    def top(self) -> float:
        return float(self.centre[2] + self.edges[2] / 2)


def _forces_on(above: int, boxes: list[_Box]) -> list[tuple[int, int, Floats]]:
    """Return where vertical forces act on a box: its number, that of the one below or `GROUND`, and the place, (2,), m."""
    box, forces = boxes[above], []
    at = float(box.low[2])
    faces = [(GROUND, box.low[:2], box.high[:2])] if at < _SAME else []
    for below in (number for number, other in enumerate(boxes) if abs(other.top - at) < _SAME):
        low, high = np.maximum(box.low, boxes[below].low)[:2], np.minimum(box.high, boxes[below].high)[:2]
        if (high > low).all():
            faces.append((below, low, high))
    for below, low, high in faces:
        inwards = _INWARDS * (high - low)
        for x, y in product(*zip(low + inwards, high - inwards, strict=True)):
            forces.append((above, below, np.array([x, y])))
    return forces


def _is_carried(boxes: list[_Box]) -> bool:
    """Return whether forces act on both sides of the centre of the last box, without which it cannot stand."""
    places = [place for *_, place in _forces_on(len(boxes) - 1, boxes)]
    centre = boxes[-1].centre[:2]
    return bool(places) and bool(((np.min(places, axis=0) < centre) & (centre < np.max(places, axis=0))).all())


def stands(boxes: list[_Box]) -> bool:
    """Return whether forces that push, and lie well inside of the faces, balance the weight of each box."""
    forces = [force for above in range(len(boxes)) for force in _forces_on(above, boxes)]
    balance, weights = np.zeros((len(boxes), 3, len(forces))), np.zeros((len(boxes), 3))
    weights[:, 0] = [GRAVITY * box.mass for box in boxes]
    for column, (above, below, place) in enumerate(forces):
        for body, sign in ((above, 1.0), (below, -1.0)):
            if body != GROUND:
                balance[body, :, column] += sign * np.array([1.0, *(place - boxes[body].centre[:2])])
    _, left = nnls(balance.reshape(-1, len(forces)), weights.ravel())
    return bool(left < _BALANCED * np.abs(weights).max())


def draw(random: np.random.Generator, count: int, spread: float) -> list[_Box]:
    """Put boxes of 0.3 to 1.2 m, with masses of 1 kg times or by up to 10**spread, on each other as long as they stand."""
    boxes: list[_Box] = []
    while len(boxes) < count:
        edges, mass = random.uniform(0.3, 1.2, 3) * (1.0, 1.0, 0.6), 10.0 ** random.uniform(-spread, spread)
        at, halves = random.uniform(-0.8, 0.8, 2), [(box.edges + edges)[:2] / 2 for box in boxes]
        beside = [np.abs(box.centre[:2] - at) - half for box, half in zip(boxes, halves, strict=True)]
        top = max((box.top for box, gap in zip(boxes, beside, strict=True) if (gap < 0.0).all()), default=0.0)
        near = [box.top for box, gap in zip(boxes, beside, strict=True) if (gap < _APART).all()]
        if all(high == top or high < top - _APART for high in near):
            new = _Box(np.append(at, top + edges[2] / 2), edges, mass)
            more = [*boxes, new]
            boxes = more if _is_carried(more) and stands(more) else boxes
    return boxes


def _scene(boxes: list[_Box]) -> Scene:
    builder = Builder()
    builder.plane()
    for box in boxes:
        builder.box(box.edges, position=box.centre, mass=box.mass)
    return builder.scene()


def _trial(spread: float, members: int = 6) -> Trial:
    random = np.random.default_rng(31)
    scenes = tuple(_scene(draw(random, int(random.integers(6, 22)), spread)) for _ in range(members))
    masses = f"masses up to 1:{10.0 ** (2 * spread):.0f}" if spread else "equal masses"
    return Trial(f"{members} stacks drawn at random, {masses}", scenes, 10.0, (rests(), stays(0.03), sinks(0.05)))


def _chimney(random: np.random.Generator) -> Scene:
    """Build 66 to 180 blocks in rings of 5 to 12, every other of them turned by half a block."""
    count = int(random.integers(5, 13))
    rings = int(random.integers(66 // count + 1, 180 // count + 1))
    builder = Builder(friction=random.uniform(0.4, 0.8))
    builder.plane()
    radius, height, thickness = random.uniform(0.5, 2.0), random.uniform(0.1, 0.3), random.uniform(0.2, 0.4)
    width = random.uniform(0.75, 0.95) * 2 * (radius - thickness / 2) * np.tan(np.pi / count)
    for ring in range(rings):
        for block in range(count):
            angle = 2 * np.pi * (block + 0.5 * (ring % 2)) / count
            at = (radius * np.cos(angle), radius * np.sin(angle), (ring + 0.5) * height)
            turn = (np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2))
            builder.box((thickness, width, height), position=at, orientation=turn)
    return builder.scene()


def _chimneys(members: int = 8) -> Trial:
    random = np.random.default_rng(32)
    scenes = tuple(_chimney(random) for _ in range(members))
    return Trial(f"{members} chimneys of 66 to 180 blocks", scenes, 10.0, (rests(0.01), stays(0.05)))


TRIALS = (_trial(0.0), _trial(1.0), _trial(2.0), _chimneys())
