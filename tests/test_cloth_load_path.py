"""Bodies that lie on cloth and ropes that lie on other bodies: the load passes through, and friction on both sides holds."""

import numpy as np
import pytest
from loads_on_cloth import acceleration, creep, distance

import kickdrift as kd

STEP = 1 / 60


def book_on_cloth(mass=1.0, vertices=21, ground="plane", book_first=False):
    """Return a world, its cloth, a book on it and what both lie on; the top of a table is at 0.5 m."""
    world, top = kd.World(), 0.5 if ground == "table" else 0.0
    table = world.add_plane()
    at = top + 0.003
    book = world.add_box((0.12, 0.12, 0.1), position=(0, 0, at + 0.053), mass=mass) if book_first else None
    if ground == "table":
        table = world.add_box((2, 2, 0.5), position=(0, 0, 0.25), mass=5.0)
    elif ground == "box":
        world.add_box((4, 4, 1), position=(0, 0, -0.5), static=True)
    cloth = world.add_cloth_grid((1, 1), (vertices, vertices), position=(0, 0, at))
    if book is None:
        book = world.add_box((0.12, 0.12, 0.1), position=(0, 0, at + 0.053), mass=mass)
    return world, cloth, book, table


@pytest.mark.parametrize("book_first", [False, True])
@pytest.mark.parametrize("vertices", [11, 21])
@pytest.mark.parametrize(
    ("ground", "mass"), [(ground, mass) for ground in ("plane", "box", "table") for mass in (0.1, 1.0, 10.0)]
)
def test_a_book_on_a_tablecloth_does_not_sink_through_it(ground, mass, vertices, book_first):
    world, _, book, table = book_on_cloth(mass, vertices, ground, book_first)
    world.advance(STEP, 120)
    top = table.position[2] + 0.25 if ground == "table" else 0.0
    assert book.position[2] - 0.05 - top == pytest.approx(0.005, abs=4e-4 if ground == "table" else 2e-4)
    assert np.abs(book.velocity).max() < 0.001


@pytest.mark.parametrize("load", [5.0, 50.0])
def test_a_loose_table_does_not_sink_in_under_a_load_on_its_cloth(load):
    world, _, book, table = book_on_cloth(load, ground="table")
    world.advance(STEP, 120)
    assert table.position[2] == pytest.approx(0.25, abs=2e-4)
    assert np.abs([book.velocity, table.velocity]).max() < 0.001


@pytest.mark.parametrize("seed", [0, 2, 14, 23, 24, 29])
def test_stacks_with_cloth_in_them_stand_still(seed):
    """Masses of 0.2 to 20 kg in any order."""
    assert creep(seed) < 0.5


def test_momentum_where_cloth_lies_between_bodies_that_are_free():
    """What contacts hold acts a substep later, and nothing is lost."""
    world = kd.World(gravity=(0, 0, 0))
    boxes = [world.add_box((0.3, 0.3, 0.1), position=(0, 0, z), mass=1.0) for z in (0.05, 0.1502)]
    world.add_cloth_grid((0.4, 0.4), (11, 11), position=(0, 0, 0.203))
    boxes.append(world.add_box((0.2, 0.2, 0.1), position=(0, 0, 0.27), velocity=(0, 0, -2.0), mass=5.0))
    momentum = world.momentum()
    world.advance(STEP, 60)
    assert world.momentum() == pytest.approx(momentum, abs=1e-9)
    assert max(body.velocity[2] for body in boxes) < -0.5


def test_a_book_on_a_tablecloth_that_is_pulled_goes_with_it():
    world, cloth, book, _ = book_on_cloth()
    world.advance(STEP, 60)
    edge = np.flatnonzero(cloth.position[:, 0] > 0.499)
    cloth.pin(edge)
    cloth.velocity[edge, 0] = 0.2
    world.advance(STEP, 180)
    assert book.position[0] > 0.1
    assert book.position[2] == pytest.approx(0.055, abs=2e-4)


@pytest.mark.parametrize("weighs", [True, False], ids=["gravity", "force"])
@pytest.mark.parametrize("kind", ["box", "cylinder"])
@pytest.mark.parametrize("mass", [0.2, 1.0])
@pytest.mark.parametrize("steepness", [0.8, 0.95, 1.1])
def test_on_a_cloth_on_a_slope_a_body_slides_from_the_angle_of_friction_on(steepness, mass, kind, weighs):
    """Its weight may be a force in a world without gravity, in which the cloth is only pulled tight."""
    if steepness > 1.0 and not weighs:
        pytest.skip("nothing else holds the cloth")
    angle, world = np.arctan(0.6 * steepness), kd.World(gravity=(0, 0, -9.81 if weighs else 0.0))
    up, along = np.array([-np.sin(angle), 0, np.cos(angle)]), np.array([np.cos(angle), 0, np.sin(angle)])
    world.add_plane(normal=up, friction=0.6)
    turn = (np.cos(angle / 2), 0, -np.sin(angle / 2), 0)
    fabric = {"friction": 0.6, "damping": 1e-3, "stretch_stiffness": 2000.0, "shear_stiffness": 400.0}
    cloth = world.add_cloth_grid((1, 1), (21, 21), position=0.0026 * up, orientation=turn, **fabric)
    cloth.pin(np.flatnonzero(cloth.position @ along > 0.499))
    start = {"position": 0.0551 * up, "orientation": turn, "mass": mass, "friction": 0.6}
    body = world.add_box((0.12, 0.12, 0.1), **start) if kind == "box" else world.add_cylinder(0.06, 0.1, **start)
    for _ in range(36):
        if not weighs:
            world.apply_force(body, (0, 0, -9.81 * mass))
        world.step(STEP)
    slides = 0.5 * 9.81 * max(np.sin(angle) - 0.6 * np.cos(angle), 0.0) * 0.6**2
    assert -(body.position - 0.0551 * up) @ along == pytest.approx(slides, rel=0.03, abs=5e-4)


@pytest.mark.parametrize("step", [0.01, 0.010000001])
def test_a_box_that_falls_onto_cloth_does_not_sink_in_at_any_step(step):
    """With 0.01 s and three substeps, the parts of a substep do not add up to it in the last digit."""
    world = kd.World(substeps=3)
    world.add_plane()
    world.add_cloth_grid((1, 1), (21, 21), position=(0, 0, 0.003))
    box = world.add_box((0.2, 0.2, 0.1), position=(0, 0, 0.07), velocity=(0, 0, -3), mass=1.0)
    world.advance(step, 12)
    assert box.position[2] == pytest.approx(0.055, abs=3e-4)


@pytest.mark.parametrize("seed", range(6))
def test_a_load_slides_on_cloth_that_is_held_by_its_friction(seed):
    assert distance(seed) == pytest.approx(1.0, rel=0.005)


@pytest.mark.parametrize("seed", range(6))
def test_cloth_that_is_pulled_away_accelerates_its_load_by_friction(seed):
    assert acceleration(seed) == pytest.approx(1.0, rel=0.01)


@pytest.mark.parametrize("mass", [0.1, 1.0, 10.0])
def test_cloth_that_is_pulled_slowly_takes_its_load_along(mass):
    """The sled feels the friction of both weights, but for pinned vertices, which lie on it. Heavy loads slide back."""
    world = kd.World()
    world.add_plane(friction=0.4)
    fabric = {"damping": 2e-3, "stretch_stiffness": 2000.0, "shear_stiffness": 400.0, "friction": 0.4}
    cloth = world.add_cloth_grid((1, 1), (21, 21), position=(0, 0, 0.003), **fabric)
    load = world.add_box((0.4, 0.3, 0.1), position=(0, 0, 0.056), mass=mass, friction=0.4)
    sled = world.add_box((1, 1, 1), mass=1000.0, position=(0.6, 0, 0.003), velocity=(0.3, 0, 0), collides_with=())
    cloth.pin(np.flatnonzero(cloth.position[:, 0] > 0.499), sled)
    weight, momenta, places = 9.81 * (mass + cloth.mass.sum() * 20 / 21), [], []
    for _ in range(3):
        for _ in range(60):
            world.apply_force(sled, (0, 0, 9810.0))
            world.step(STEP)
        momenta.append(1000.0 * sled.velocity[0] + mass * load.velocity[0] + (cloth.mass * cloth.velocity[:, 0]).sum())
        places.append(load.position[0])
    assert momenta[0] - momenta[2] == pytest.approx(2.0 * 0.4 * weight, rel=0.02)
    assert places[2] - places[0] == pytest.approx(0.6, rel=0.08 if mass < 5.0 else 0.4)


def test_a_book_on_a_fine_tablecloth_does_not_sink_through_it():
    world, _, book, _ = book_on_cloth(vertices=41)
    world.advance(STEP, 120)
    assert book.position[2] == pytest.approx(0.055, abs=2e-4)


@pytest.mark.parametrize("box_first", [False, True])
def test_a_box_on_two_ropes_does_not_sink_through_them(box_first):
    world = kd.World()
    world.add_plane()
    start = {"position": (0, 0, 0.072), "mass": 1.0}
    box = world.add_box((0.4, 0.4, 0.1), **start) if box_first else None
    for y in (-0.1, 0.1):
        world.add_rope([(x, y, 0.011) for x in np.linspace(-0.3, 0.3, 25)], radius=0.01)
    if box is None:
        box = world.add_box((0.4, 0.4, 0.1), **start)
    world.advance(STEP, 120)
    assert box.position[2] == pytest.approx(0.07, abs=2e-4)


def test_forces_of_users_change_nothing_in_loads_of_cloth():
    def nothing(force):
        force[0, 0] += 0.0

    places = []
    for forces in (False, True):
        world, _, book, table = book_on_cloth(5.0, ground="table")
        if forces:
            world.add_force(nothing)
        world.advance(STEP, 30)
        places.append(np.concatenate((book.position, table.position)))
    assert places[0] == pytest.approx(places[1], abs=1e-9)


@pytest.mark.parametrize("restitution", [0.5, 1.0])
@pytest.mark.parametrize("mass", [2.0, 16.0])
def test_boxes_that_bounce_with_cloth_between_them_gain_no_energy(mass, restitution):
    world = kd.World(substeps=8)
    world.add_plane(restitution=restitution)
    lower = world.add_box((0.4, 0.4, 0.2), position=(0, 0, 0.5), mass=1.0, restitution=restitution)
    world.add_cloth_grid((0.6, 0.6), (13, 13), position=(0, 0, 0.6035), damping=1e-3)
    upper = world.add_box((0.2, 0.2, 0.1), position=(0, 0, 0.6562), mass=mass, restitution=restitution)
    start = 9.81 * (0.4 + mass * 0.4)
    for _ in range(60):
        world.step(STEP)
        moving = sum(0.5 * body.mass * body.velocity @ body.velocity for body in (lower, upper))
        assert moving + 9.81 * (lower.position[2] - 0.1 + mass * (upper.position[2] - 0.2562)) < 1.02 * start


def test_a_load_on_cloth_on_a_sprung_box_stays_calm():
    world, total = kd.World(), 2.5
    box = world.add_box((0.3, 0.3, 0.1), position=(0, 0, 0), mass=0.5, locked_rotation=True)
    stiffness = total * (4 * np.pi) ** 2
    world.add_spring(None, box, (0, 0, -2), (0, 0, 0), length=2 + total * 9.81 / stiffness, stiffness=stiffness)
    world.add_cloth_grid((0.4, 0.4), (11, 11), position=(0, 0, 0.0536), damping=1e-3)
    load = world.add_box((0.2, 0.2, 0.1), position=(0, 0, 0.1076), mass=2.0, locked_rotation=True)
    world.advance(STEP, 120)
    assert np.abs([box.velocity, load.velocity]).max() < 0.1


def test_momentum_of_loads_is_kept_where_steps_change_in_length():
    world, given, rng = kd.World(gravity=(0, 0, 0)), 0.0, np.random.default_rng(1)
    for z in (0.05, -0.051):
        world.add_box((0.3, 0.3, 0.1), position=(0, 0, z), mass=1.0)
    world.add_cloth_grid((0.4, 0.4), (11, 11), position=(0, 0, 0.103))
    load = world.add_box((0.2, 0.2, 0.1), position=(0, 0, 0.157), mass=5.0)
    for step in rng.choice([1 / 600, 1 / 30], 40):
        world.apply_force(load, (0, 0, -50.0))
        world.step(step)
        given -= 50.0 * step
    off = []
    for _ in range(10):  # the loads of a cloth that is touched reach the other body one step later
        world.step(STEP)
        off.append(abs(world.momentum()[2] - given))
    assert np.median(off) < 1e-9


def test_loads_of_removed_cloths_are_gone():
    world, cloth, book, table = book_on_cloth(50.0, ground="table")
    world.advance(STEP, 30)
    world.remove_cloth(cloth)
    world.remove(book)
    world.add_cloth_grid((1, 1), (5, 5), position=(9, 0, 3))
    table.position, table.velocity, table.angular_velocity = (5, 0, 2), (0, 0, 0), (0, 0, 0)
    world.step(STEP)
    assert table.velocity == pytest.approx((0, 0, -9.81 * STEP), abs=1e-12)


@pytest.mark.parametrize("seed", [2, 5, 12])
def test_a_cloth_of_29_kg_that_falls_on_a_box_of_10_g_gains_no_energy(seed):
    random = np.random.default_rng(seed)
    world = kd.World()
    world.add_plane(friction=0.5)
    size = random.uniform(0.1, 0.25, 3)
    world.add_box(tuple(size), position=(*random.uniform(-0.35, 0.35, 2), size[2] / 2), mass=0.01, friction=0.5)
    world.add_cloth_grid((1.2, 1.2), (23, 23), position=(0, 0, 0.4), density=20.0, thickness=0.01)
    start = sum(world.energy())
    for _ in range(60):
        world.step(1 / 60)
        assert sum(world.energy()) < 1.01 * start
