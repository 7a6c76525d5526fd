"""The step of a world: its word, its vector instructions, and its stages run uncompiled."""

import re

import numpy as np
import pytest
from stages import run_stage

import kickdrift as kd
from kickdrift.core.compilation import compiled
from kickdrift.world.contacts import contact_solver_simd
from kickdrift.world.tables import CONTACT, MANIFOLD, MOTION, POSE


def stack(**options):
    world = kd.World(**options)
    world.add_plane(friction=0.6)
    for k in range(3):
        world.add_box((1.0, 1.0, 1.0), position=(0.05 * k, 0.0, 0.5 + k), friction=0.6)
    world.add_sphere(0.2, position=(2.0, 0.0, 0.25), velocity=(1.0, 0.0, -1.0), restitution=0.5)
    world.add_box((0.1, 0.2, 0.6), position=(-2.0, 0.0, 2.0), angular_velocity=(3.0, 2.0, 1.0))
    return world


def test_the_word_says_what_a_step_does():
    word = stack().word
    assert str(word) == (
        "begin place-shapes begin-forces find-pairs find-points divide-fast-rotation pass-on-impulses find-heaps"
        " colour prepare find-bouncing begin-paths"
        " (begin-forces kick bounce refresh-hit warm-start solve drift relax follow-paths)*"
        " find-missed divide-fast-rotation measure-residual ask-again drop-paths find-lost store finish count-unsolved"
        " note-touching"
    )


def test_stages_that_a_world_has_no_use_for_are_not_in_its_word():
    world = kd.World()
    world.add_plane()
    world.add_box((1, 1, 1), position=(0, 0, 0.5))
    assert "bounce" not in str(world.word)
    assert "sleep" in str(kd.World(sleeping=True).word)
    assert "flatten" in str(kd.World(plane_normal=(0, 1, 0)).word)


@pytest.mark.parametrize("kernel", contact_solver_simd.KERNELS.values(), ids=lambda kernel: kernel.__name__)
def test_kernels_over_lanes_are_vector_instructions(kernel):
    fresh = compiled(fast=True, cached=False)(kernel.py_func)
    assembly = fresh.get_compile_result(contact_solver_simd.KERNEL).library.get_asm_str()
    packed = re.findall(r"^\s+v?(?:mul|add|sub|max|min|fn?madd\d*|fn?msub\d*)pd\b", assembly, re.MULTILINE)
    single = re.findall(r"^\s+v?(?:mul|add|sub|max|min|fn?madd\d*|fn?msub\d*)sd\b", assembly, re.MULTILINE)
    # What is left after whole vectors is done one by one, by as many instructions again.
    assert len(packed) >= 0.8 * len(single) > 40


def test_lanes_that_touch_each_other_would_not_be_vector_instructions():
    def chained(own, s, per_h, soft, push, n):
        for lane in range(1, n):
            own[lane] = own[lane - 1] * s[lane] + soft

    fresh = compiled(fast=True, cached=False)(chained)
    assembly = fresh.get_compile_result(contact_solver_simd.KERNEL).library.get_asm_str()
    assert not re.findall(r"^\s+v?(?:mul|fn?madd\d*)pd\b", assembly, re.MULTILINE)


def test_the_same_input_gives_the_same_bits():
    first, second = stack(), stack()
    first.advance(1 / 60, 50)
    for _ in range(50):
        second.step(1 / 60)
    for table in (POSE, MOTION, CONTACT, MANIFOLD):
        assert first.tables.array(table).tobytes() == second.tables.array(table).tobytes()


@pytest.mark.parametrize(
    "name", ["begin", "place_shapes", "colour", "begin_forces", "kick", "drift", "store", "note_touching", "finish"]
)
def test_stages_do_the_same_uncompiled(name):
    compiled_world, interpreted = stack(), stack()
    for world in (compiled_world, interpreted):
        world.advance(1 / 60, 20)
    word = compiled_world.word
    for stage in (*word.before, *word.substep, *word.after):
        run_stage(stage, 1 / 240, compiled_world.tables)
        if stage.__name__ == name:
            stage.py_func(0.0, 1 / 240, interpreted.tables.address)
        else:
            run_stage(stage, 1 / 240, interpreted.tables)
    for table in (POSE, MOTION):
        np.testing.assert_allclose(
            compiled_world.tables.array(table), interpreted.tables.array(table), rtol=1e-13, atol=1e-15
        )
