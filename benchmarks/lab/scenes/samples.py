"""Samples of Solver2D, Box2D and Box3D, in three dimensions, and of SimBenchmark."""

import itertools

import numpy as np

from benchmarks.lab.building import GROUND, Builder
from benchmarks.lab.measures import apart, at_most, keeps, overlaps, rests, sinks, stays
from benchmarks.lab.scenes.planar import hang_planks
from benchmarks.lab.scenes.towers import standing
from benchmarks.lab.trial import Trial
from benchmarks.world.described import Floats, Scene
from benchmarks.world.judge import Watched, energies


def _about_y(angle: float) -> Floats:
    return np.array([np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0])


def _card_house(storeys: int, thick: float) -> Trial:
    """Lean pairs of cards of 0.4 m against each other at 25 degrees, with cards laid across from pair to pair.

    Those across end 1 mm apart above a pair, where cards of 0.4 m would be in each other. Statics asks for friction of
    tan(25 degrees), 0.466.
    """
    builder, lean, half = Builder(friction=0.7), np.radians(25.0), 0.2
    builder.plane()
    high = half * np.cos(lean) + thick / 2 * np.sin(lean)  # of a leaning card's centre
    wide = half * np.sin(lean) + thick / 2 * np.cos(lean)  # from there to where the pair meets
    for storey in range(storeys):
        floor, pairs = storey * (2 * high + thick), storeys - storey
        for pair in range(pairs):
            x = (4 * pair + 2 * storey) * wide
            for side in (-1.0, 1.0):
                place = (x + side * wide, 0.0, floor + high)
                builder.box((thick, 0.3, 2 * half), position=place, orientation=_about_y(-side * lean))
            if pair < pairs - 1:
                place = (x + 2 * wide, 0.0, floor + 2 * high + thick / 2)
                builder.box((4 * wide - 1e-3, 0.3, thick), position=place)
    name = f"card house of {storeys} storeys, {1000 * thick:g} mm"
    return Trial(name, (builder.scene(),), 10.0, (rests(), stays(0.1), sinks(0.1)))


def _arch(stones: int = 11, ratio: float = 0.2) -> Trial:
    """Half a circle of stones, as thick as a fifth of its radius: statics holds it above 0.1075 (Milankovitch, 1907)."""
    builder, radius = Builder(friction=0.6), 4.0
    builder.plane()
    inner, outer, wide = radius * (1 - ratio / 2), radius * (1 + ratio / 2), np.pi / stones / 2
    profile = [(r * np.sin(side * wide), r * np.cos(wide)) for r in (inner, outer) for side in (-1, 1)]
    points = np.array([(x, y, z) for x, z in profile for y in (-0.5, 0.5)])
    for k in range(stones):
        builder.hull(points, orientation=_about_y(np.pi / 2 - (2 * k + 1) * wide))
    return Trial("arch of 11 stones", (builder.scene(),), 10.0, (rests(), stays(0.1), sinks(0.1)))


def _heavy_tips() -> Trial:
    """Pyramids of ten rows whose tips are 100, 200 and 300 times as dense."""
    builder = Builder()
    builder.plane()
    for k, ratio in enumerate((100.0, 200.0, 300.0)):
        for row in range(10):
            for place in range(10 - row):
                x = (place - (9 - row) / 2) * 1.0
                builder.box((1.0, 1.0, 1.0), position=(x, 5.0 * k, row + 0.5), mass=ratio if row == 9 else 1.0)
    return standing("pyramids under tips of 100, 200, 300 times", builder.scene(), 1.0, quick=False)


def _big_box() -> Trial:
    """Put a cube of 20 m on two of 1 m, all as dense."""
    builder = Builder()
    builder.plane()
    for side in (-1.0, 1.0):
        builder.box((1.0, 1.0, 1.0), position=(9.0 * side, 0.0, 0.5), density=1.0)
    builder.box((20.0, 20.0, 20.0), position=(0.0, 0.0, 11.0), density=1.0)
    return standing("cube of 20 m on two of 1 m", builder.scene(), 1.0, deep=0.5)


def _double_domino(count: int = 15) -> Trial:
    """Push the first of a row of dominoes with its neighbours 1 m away; all fall."""
    builder = Builder()
    builder.plane()
    for k in range(count):
        push = {"velocity": (0.8, 0.0, 0.0), "angular_velocity": (0.0, 1.6, 0.0)} if k == 0 else {}
        builder.box((0.25, 1.0, 1.0), position=(0.7 * k, 0.0, 0.5), density=100.0, **push)

    def standing_still(scene: Scene, watched: Watched) -> float:
        return float((watched.poses[-1, 1:, 2] > 0.49).sum())

    return Trial(
        "dominoes of Box2D", (builder.scene(),), 10.0, (at_most("left standing", "", standing_still, 0.0), rests())
    )


def _cantilever(count: int = 8) -> Trial:
    """Weld bars to each other and to a wall: nothing sags."""
    builder = Builder()
    before = GROUND
    for k in range(count):
        bar = builder.box((1.0, 0.25, 0.25), position=(k + 0.5, 0.0, 0.0), density=1000.0)
        builder.join("fixed", before, bar, (float(k), 0.0, 0.0))
        before = bar
    return Trial("cantilever of 8 bars", (builder.scene(),), 10.0, (rests(), sinks(0.05), apart(0.01)))


def _confined(side: int = 10) -> Trial:
    """Put balls that overlap by a fifth into a box that is too small for them, in a plane: none gets out."""
    random, builder, pitch, radius = np.random.default_rng(2), Builder(0.0, planar=True), 0.8, 0.5
    room = side * pitch / 2
    for normal in ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)):
        builder.plane(normal, position=-room * np.array(normal))
    places = (np.arange(side) - (side - 1) / 2) * pitch
    for x, z in itertools.product(places, places):
        aside = random.uniform(-0.05, 0.05, 2)
        builder.sphere(radius, position=(x + aside[0], 0.0, z + aside[1]), mass=1.0)

    def outside(scene: Scene, watched: Watched) -> float:
        return float(np.abs(watched.poses[:, 4:, :3]).max() - room)

    criteria = (at_most("outside", "m", outside, 0.0), rests(0.1))
    return Trial("planar: 100 balls in too small a box", (builder.scene(),), 10.0, criteria)


def _recovery(rows: int = 4, share: float = 0.25) -> Trial:
    """Let a pyramid whose boxes overlap by a quarter push itself apart, without jumping."""
    builder = Builder()
    builder.plane()
    pitch = 1.0 - share
    for row in range(rows):
        for place in range(rows - row):
            x = (place - (rows - 1 - row) / 2) * pitch
            builder.box((1.0, 1.0, 1.0), position=(x, 0.0, 0.5 + row * pitch), mass=1.0)

    def fastest(scene: Scene, watched: Watched) -> float:
        return float(np.abs(watched.motions[:, 1:, :3]).max())

    criteria = (rests(), at_most("fastest", "m/s", fastest, 5.0), overlaps(0.05))
    return Trial("overlap recovery", (builder.scene(),), 10.0, criteria, looks=200)


def _mixed_heaps(members: int = 48) -> Trial:
    """Let heaps of boxes of 10 g to 300 kg settle that overlap by up to a sixth: what pushes them apart lifts them."""
    random, scenes = np.random.default_rng(7), []
    for _ in range(members):
        builder, size, height = Builder(friction=random.uniform(0.05, 0.9)), 10.0 ** random.uniform(-2, 0.5), 0.0
        builder.plane()
        for _ in range(random.integers(3, 20)):
            edges, turn = (
                size * random.uniform(0.3, 1.0, 3),
                (1.0, *0.05 * random.normal(size=3) * (random.uniform() < 0.3)),
            )
            place = (*size * random.uniform(-0.15, 0.15, 2), height + random.uniform(0.42, 0.5) * edges[2])
            builder.box(edges, position=place, orientation=turn, mass=10.0 ** random.uniform(-2, 2.5))
            height = place[2] + random.uniform(0.42, 0.5) * edges[2]
        scenes.append(builder.scene())

    def risen(scene: Scene, watched: Watched) -> float:
        looks = range(len(watched.times))
        whole = [energies(scene, watched.poses[k], watched.motions[k])[1] for k in looks]
        return max(whole) / whole[0] - 1

    return Trial(
        "48 heaps of boxes that overlap", tuple(scenes), 1.0, (at_most("energy risen", "", risen, 0.25),), looks=60
    )


def _bridge(planks: int = 40) -> Trial:
    """Hang a bridge of planks on hinges between two points, an arc at first, and let it swing."""
    builder = Builder()
    hang_planks(builder, np.linspace(0.3, -0.3, planks), 0.5, 5.0)
    return Trial("bridge of 40 planks", (builder.scene(),), 5.0, (apart(0.01),))


def _far() -> Trial:
    """Stack a pyramid 20 km from the origin."""
    builder = Builder(at=(2e4, 2e4, 0.0))
    builder.plane()
    for row in range(10):
        for place in range(10 - row):
            x = (place - (9 - row) / 2) * 1.0
            builder.box((1.0, 1.0, 1.0), position=(x, 0.0, row + 0.5), density=100.0)
    return standing("pyramid of 55, 28 km from the origin", builder.scene(), 1.0)


def _bouncing(side: int = 7) -> Trial:
    """Drop 49 balls with e = 1; SimBenchmark measures what becomes of their energy."""
    builder, mass, height = Builder(friction=0.0, restitution=1.0), 10.0, 5.0
    builder.plane()
    for x, y in itertools.product(range(side), range(side)):
        builder.sphere(0.1, position=(2.0 * x, 2.0 * y, height), mass=mass)
    spread = side * side * mass * 9.81 * height
    return Trial("49 balls bouncing, e = 1", (builder.scene(),), 10.0, (keeps(0.01, spread),), looks=100)


def _crowd(side: int = 6) -> Trial:
    """Let 216 frictionless balls collapse; SimBenchmark's 666 measures how deep they are in each other."""
    random, builder = np.random.default_rng(666), Builder(friction=0.0)
    builder.plane()
    for x, y, z in itertools.product(range(side), range(side), range(side)):
        place = np.array([0.21 * x, 0.21 * y, 0.101 + 0.21 * z]) + random.uniform(0.0, 1e-3, 3)
        builder.sphere(0.1, position=place, mass=10.0)

    def risen(scene: Scene, watched: Watched) -> float:
        kinetic = 5.0 * (watched.motions[:, 1:, :3] ** 2).sum(axis=(1, 2))
        whole = kinetic + 98.1 * watched.poses[:, 1:, 2].sum(axis=1)
        return float(whole.max() / whole[0] - 1)

    criteria = (overlaps(0.01), at_most("energy risen", "", risen, 0.01))
    return Trial("216 balls collapsing", (builder.scene(),), 3.0, criteria, quick=False)


def _kapla(layers: int = 16) -> Trial:
    """Stack pairs of Kapla planks crosswise, at their real size."""
    builder, size = Builder(friction=0.5), np.array([0.1176, 0.0235, 0.0078])
    builder.plane()
    for layer in range(layers):
        for side in (-0.045, 0.045):
            along = layer % 2 == 0
            place = (0.0, side) if along else (side, 0.0)
            edges = size if along else size[[1, 0, 2]]
            builder.box(edges, position=(*place, (layer + 0.5) * size[2]), density=600.0)
    return standing("Kapla planks, 16 layers", builder.scene(), size[2])


def _ball_pile(rolling: float = 0.0) -> Trial:
    """Drop 64 balls of 0.2 m into a pen, in which they come to rest if something resists rolling.

    Else a ball that is pressed at two points or fewer turns on about the line through them, where nothing slides. With five
    other random places, some roll after 10 s at 5e-4 to 1e-2 m/s: in all five runs of kickdrift, in three of Box3D.
    """
    random, builder = np.random.default_rng(4), Builder()
    builder.plane()
    for way in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        normal = np.array([*way, 0.0])
        builder.box(
            0.2 * np.abs(normal) + 3.0 * (1 - np.abs(normal)), position=[*(-1.1 * normal[:2]), 1.0], static=True
        )
    for x, y, z in itertools.product(range(4), range(4), range(4)):
        place = 0.45 * np.array([x - 1.5, y - 1.5, z + 1.0]) + random.uniform(-0.02, 0.02, 3)
        builder.sphere(0.2, position=place, density=500.0, rolling=rolling)
    name = "64 balls in a pen" + (f", rolling resistance of {1e3 * rolling:.0f} mm" if rolling > 0 else "")
    return Trial(name, (builder.scene(),), 10.0, (rests(), overlaps(0.02)), quick=False)


TRIALS = (
    _card_house(5, 0.01),
    _card_house(3, 0.02),
    _arch(),
    _heavy_tips(),
    _big_box(),
    _double_domino(),
    _cantilever(),
    _confined(),
    _recovery(),
    _mixed_heaps(),
    _bridge(),
    _far(),
    _bouncing(),
    _crowd(),
    _kapla(),
    _ball_pile(),
    _ball_pile(0.002),
)
