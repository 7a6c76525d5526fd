"""Batches: parts of a world that nothing connects do their substeps one after the other, with the same bits."""

import numpy as np
import pytest

import kickdrift as kd
from kickdrift.core.errors import LostBodyError
from kickdrift.world.batch_view import AFTER_MEMBER, FIRST_MEMBER
from kickdrift.world.contacts import layout as c
from kickdrift.world.contacts.batch_division import FEW, OWN_BATCH, find_batches
from kickdrift.world.layout import BODY_KIND, STATIC
from kickdrift.world.step import stepping
from kickdrift.world.tables import BATCH, BODY, CONTACT, LOAD, MANIFOLD, MEMBER, MEMBERSHIP, MOTION, POSE

STEP = 1 / 60


def stacks(monkeypatch, few, *, sleeping=False):
    """Sixty stacks of five boxes, some falling, beside balls on a moving platform, in a world that calls so many bodies few."""
    monkeypatch.setattr(stepping, "FEW", few)
    world = kd.World(sleeping=sleeping)
    world.add_plane()
    for k in range(300):
        stack, level = divmod(k, 5)
        world.add_box(
            (1, 1, 1), position=(2.0 * stack + 0.01 * level, 0.0, 1.01 * level + 0.5 + 0.01 * stack), friction=0.6
        )
    world.add_box((20, 2, 1), kinematic=True, position=(0, 5, 0.5), velocity=(0.3, 0, 0), friction=0.5)
    for k in range(8):
        world.add_sphere(0.4, position=(2.2 * k - 8, 5, 1.45))
    return world


def same_bits(first, second):
    return all(
        first.tables.array(table).tobytes() == second.tables.array(table).tobytes()
        for table in (POSE, MOTION, MANIFOLD)
    )


@pytest.mark.parametrize("sleeping", [False, True])
def test_batches_change_no_bit(monkeypatch, sleeping):
    whole = stacks(monkeypatch, 10**6, sleeping=sleeping)
    whole.advance(STEP, 40)
    batched = stacks(monkeypatch, 0, sleeping=sleeping)
    batched.advance(STEP, 40)
    assert whole.tables.count(BATCH) == 0
    assert batched.tables.count(BATCH) > 1
    assert same_bits(whole, batched)
    assert batched.residual == whole.residual
    assert sleeping or whole.residual > 0.0


def test_every_body_is_in_one_batch_and_no_contact_between_two(monkeypatch):
    world = stacks(monkeypatch, 0)
    world.advance(STEP, 30)
    batches, member = world.tables.array(BATCH), world.tables.array(MEMBER)[:, 0]
    own, kind = world.tables.array(MEMBERSHIP)[:, OWN_BATCH], world.tables.array(BODY)[:, BODY_KIND]
    assert sorted(member) == list(range(len(world.position)))
    for k, row in enumerate(batches):
        assert set(own[member[row[FIRST_MEMBER] : row[AFTER_MEMBER]]]) == {k}
    contacts = world.tables.array(CONTACT)
    a, b = contacts[contacts[:, c.POINTS] > 0][:, [c.BODY_A, c.BODY_B]].T
    free = (kind[a] != STATIC) & (kind[b] != STATIC)
    assert free.sum() > 200
    assert (own[a] == own[b])[free].all()


def test_worlds_are_batched_where_nothing_in_their_substeps_looks_further(monkeypatch):
    assert "find-batches" in str(stacks(monkeypatch, 0).word)
    bouncing, jointed, forced = (stacks(monkeypatch, 0) for _ in range(3))
    bouncing.add_sphere(0.5, position=(0, 20, 5), restitution=0.5)
    jointed.add_hinge(None, jointed.add_box((1, 1, 1), position=(0, 20, 5)), anchor=(0, 20, 5), axis=(0, 1, 0))
    forced.add_force(lift)
    for world in (bouncing, jointed, forced, stacks(monkeypatch, FEW)):
        assert "find-batches" not in str(world.word)


def lift(position, force):
    force[1, 2] += 1e-9 * position[1, 2]


def test_batches_come_and_go_with_the_bodies(monkeypatch):
    world = stacks(monkeypatch, 300)
    world.advance(STEP, 2)
    assert world.tables.count(BATCH) > 1
    world.add_sphere(0.5, position=(0, 20, 5), restitution=0.5)
    world.advance(STEP, 2)
    assert world.tables.count(BATCH) == 0
    assert sorted(world.tables.array(MEMBER)[:, 0]) == list(range(len(world.position)))


def test_a_body_lost_in_one_batch_leaves_all_where_they_were(monkeypatch):
    world = stacks(monkeypatch, 0)
    world.advance(STEP, 10)
    before = world.position.copy()
    world.velocity[250] = (1e308, 0, 1e308)
    world.velocity[251] = (-1e308, 0, 1e308)
    with pytest.raises(LostBodyError, match="lost"):
        world.advance(STEP, 1000)
    assert np.isfinite(world.position).all()
    assert np.isfinite(world.tables.array(MANIFOLD)[:, c.NORMAL_IMPULSE : c.TWIST_IMPULSE + 1]).all()
    np.testing.assert_array_equal(world.position[:200], before[:200])


@pytest.mark.parametrize("seed", range(1, 5))
def test_a_step_in_batches_that_is_done_in_parts_has_the_bits_of_one_without(monkeypatch, seed):
    """A box that turns fast after its impact, in the last batch, has the step divided when the others are done."""
    worlds = []
    for few in (10**6, 0):
        world = stacks(monkeypatch, few)
        world.advance(STEP, 5)
        turn = np.random.default_rng(seed).normal(size=4)
        world.add_box((0.1, 0.06, 0.02), mass=0.1, position=(0, 40, 0.3), orientation=turn, velocity=(0, 0, -120))
        world.tables.row(LOAD, 2)[0] = 60.0  # on a box of the first batch
        parts = monkeypatch_parts(monkeypatch)
        world.advance(STEP, 3)
        assert parts
        worlds.append(world)
    assert worlds[1].tables.count(BATCH) > 1
    assert same_bits(*worlds)


def monkeypatch_parts(monkeypatch):
    """Return a list to which each step that is done in parts adds something."""
    done, do_parts = [], stepping.do_parts

    def counted(do_part, tables, cause):
        done.append(1)
        do_parts(do_part, tables, cause)

    monkeypatch.setattr(stepping, "do_parts", counted)
    return done


def test_batches_are_found_the_same_uncompiled(monkeypatch):
    world = stacks(monkeypatch, 0)
    world.advance(STEP, 10)
    found = [world.tables.array(table).copy() for table in (BATCH, MEMBER, MEMBERSHIP)]
    find_batches.py_func(0.0, STEP, world.tables.address)
    for table, before in zip((BATCH, MEMBER, MEMBERSHIP), found, strict=True):
        np.testing.assert_array_equal(world.tables.array(table)[:, :2], before[:, :2])
