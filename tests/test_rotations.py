"""Quaternions for the interpreter, against matrices and SciPy."""

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from kickdrift.core.rotations import about, of_matrix, product, turn_to, turned

QUATERNIONS = arrays(np.float64, 4, elements=st.floats(-1.0, 1.0)).filter(lambda q: np.linalg.norm(q) > 0.1)


def scipys(q):
    return Rotation.from_quat(np.roll(q, -1))


@given(QUATERNIONS, QUATERNIONS)
def test_as_scipy_turns(p, q):
    p, q = p / np.linalg.norm(p), q / np.linalg.norm(q)
    vectors = np.eye(3)
    assert np.allclose(turned(p, vectors), scipys(p).apply(vectors), atol=1e-14)
    assert np.allclose(turned(product(p, q), vectors), (scipys(p) * scipys(q)).apply(vectors), atol=1e-14)
    assert np.allclose(turned(of_matrix(scipys(p).as_matrix()), vectors), scipys(p).apply(vectors), atol=1e-14)


@pytest.mark.parametrize("axis", [*np.eye(3), np.array([0.6, 0.0, 0.8])])
def test_half_turns_have_quaternions_of_their_matrices(axis):
    q = of_matrix(2.0 * np.outer(axis, axis) - np.eye(3))
    assert np.allclose(np.abs(q), (0.0, *np.abs(axis)), atol=1e-15)
    assert np.allclose(q, np.sign(q @ about(axis, np.pi)) * about(axis, np.pi), atol=1e-15)


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
@example(0.0, 0.0, -1.0)
@example(4e-5, 0.0, -1.0)
@example(0.0, 4.6e-5, -1.0)
@example(5e-324, 5e-324, -1.0)
def test_turn_to_a_direction(x, y, z):
    assume(np.hypot(np.hypot(x, y), z) > 1e-3)
    unit = np.array((x, y, z)) / np.linalg.norm((x, y, z))
    q = turn_to(unit)
    assert np.abs(turned(q, (0, 0, 1)) - unit).max() < 1e-15
    assert abs(np.linalg.norm(q) - 1.0) < 1e-15
