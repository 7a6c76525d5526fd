"""Rows of pins to bodies, sorted by cloth and then by body."""

import numpy as np
from numpy.typing import NDArray

from kickdrift.world.deformables import layout as c
from kickdrift.world.layout import ANGULAR_VELOCITY, ORIENTATION, POSITION, VELOCITY
from kickdrift.world.shapes.mass_properties import rotation_matrix
from kickdrift.world.tables import CLOTH, MOTION, PARTICLE, PIN, PIN_NUMBERS, POSE, Tables

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def add_pins(tables: Tables, particles: Integers, body: int) -> None:
    """Pin particles that are not pinned to a body at their present positions on one, and give them its velocities there."""
    rows, pose, motion = tables.array(PARTICLE), tables.array(POSE)[body], tables.array(MOTION)[body]
    arms = rows[particles, :3] - pose[POSITION : POSITION + 3]
    turning = np.cross(motion[ANGULAR_VELOCITY : ANGULAR_VELOCITY + 3], arms)
    rows[particles, c.PARTICLE_VELOCITY : c.PARTICLE_VELOCITY + 3] = motion[VELOCITY : VELOCITY + 3] + turning
    pins = np.zeros((len(particles), PIN.width), dtype=np.int64)
    numbers = np.zeros((len(particles), PIN_NUMBERS.width))
    pins[:, c.PINNED_PARTICLE], pins[:, c.PINNED_BODY] = particles, body
    local = arms @ rotation_matrix(pose[ORIENTATION : ORIENTATION + 4])
    numbers[:, c.PIN_POSITION : c.PIN_POSITION + 3] = local
    _put(tables, np.concatenate((tables.array(PIN), pins)), np.concatenate((tables.array(PIN_NUMBERS), numbers)))


def remove_pins(tables: Tables, particles: Integers) -> None:
    """Remove the pins of particles to bodies, if they have any."""
    keep = ~np.isin(tables.array(PIN)[:, c.PINNED_PARTICLE], particles)
    _put(tables, tables.array(PIN)[keep], tables.array(PIN_NUMBERS)[keep])


def copy_pins(tables: Tables, pinned_as: Integers, particles: Integers) -> None:
    """Copy the pins of the particles `pinned_as`, (K,), to other particles, (K,), that have none."""
    pins, numbers = tables.array(PIN), tables.array(PIN_NUMBERS)
    which, row = np.nonzero(pinned_as[:, None] == pins[:, c.PINNED_PARTICLE])
    copied = pins[row].copy()
    copied[:, c.PINNED_PARTICLE] = particles[which]
    _put(tables, np.concatenate((pins, copied)), np.concatenate((numbers, numbers[row])))


def _put(tables: Tables, pins: Integers, numbers: Floats) -> None:
    """Write all pins in order, and the ranges of cloths."""
    cloths = tables.array(CLOTH)
    of = np.searchsorted(cloths[:, c.LAST_PARTICLE], pins[:, c.PINNED_PARTICLE], side="right")
    order = np.lexsort((pins[:, c.PINNED_PARTICLE], pins[:, c.PINNED_BODY], of))
    tables.put(PIN, pins[order])
    tables.put(PIN_NUMBERS, numbers[order])
    numbers_of_cloths = np.arange(len(cloths))
    cloths[:, c.FIRST_PIN] = np.searchsorted(of[order], numbers_of_cloths)
    cloths[:, c.LAST_PIN] = np.searchsorted(of[order], numbers_of_cloths, side="right")
