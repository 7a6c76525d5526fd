"""The random numbers, bit for bit against published vectors and NumPy's generator."""

import math

import numpy as np
import pytest
from scipy import stats

from kickdrift.core import random
from kickdrift.core.compilation import specialise

ALL = 2**64 - 1
# Random123, tests/kat_vectors, philox4x64 with 10 rounds: counter, key, words.
PUBLISHED = [
    ((0, 0, 0, 0), (0, 0), (0x16554D9ECA36314C, 0xDB20FE9D672D0FDC, 0xD7E772CEE186176B, 0x7E68B68AEC7BA23B)),
    (
        (ALL, ALL, ALL, ALL),
        (ALL, ALL),
        (0x87B092C3013FE90B, 0x438C3C67BE8D0224, 0x9CC7D7C69CD777B6, 0xA09CAEBF594F0BA0),
    ),
    (
        (0x243F6A8885A308D3, 0x13198A2E03707344, 0xA4093822299F31D0, 0x082EFA98EC4E6C89),
        (0x452821E638D01377, 0xBE5466CF34E90C6C),
        (0xA528F45403E61D95, 0x38C72DBD566E9788, 0xA5A1610E72FD18B5, 0x57BD43B5E52B7FE6),
    ),
]
BODIES = pytest.mark.parametrize("body", [False, True], ids=["compiled", "interpreted"])


# Compiled functions return Python's integers to the interpreter, so that bodies have to call bodies.
BODY = specialise(
    random.fill_normal.py_func, "body", philox=random.philox.py_func, _fill_pair=random._fill_pair.py_func
)


def words(counter, key, body=False):
    function = random.philox.py_func if body else random.philox
    with np.errstate(over="ignore"):
        return tuple(int(word) for word in function(*(np.uint64(word) for word in (*counter, *key))))


def normal(seed, draw, n, body=False):
    out = np.full(n, np.nan)
    with np.errstate(over="ignore"):
        (BODY if body else random.fill_normal)(np.uint64(seed), np.uint64(draw), out)
    return out


@BODIES
@pytest.mark.parametrize(("counter", "key", "expected"), PUBLISHED)
def test_published_vectors(counter, key, expected, body):
    assert words(counter, key, body) == expected


def test_a_bit_of_counter_or_key_changes_every_word():
    counter, key, expected = PUBLISHED[2]
    for i in range(4):
        other = [word ^ (i == k) for k, word in enumerate(counter)]
        assert not set(words(other, key)) & set(expected)
    assert not set(words(counter, (key[0], key[1] ^ 1))) & set(expected)


@BODIES
@pytest.mark.parametrize(("seed", "draw"), [(0, 0), (1, 2), (ALL, 2**53), (0xDEADBEEF12345678, 77)])
def test_draws_are_made_of_the_stream_of_numpys_generator(seed, draw, body):
    raw = np.random.Philox(key=seed, counter=[0, draw, 0, 0]).random_raw(40)
    # Uniform numbers with 53 bits, the first of a pair from (0, 1].
    first, second = ((raw[0::2] >> np.uint64(11)) + np.uint64(1)) * 2.0**-53, (raw[1::2] >> np.uint64(11)) * 2.0**-53
    radius, angle = np.array([math.sqrt(-2 * math.log(u)) for u in first]), 2 * math.pi * second
    expected = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]).ravel()
    assert np.allclose(normal(seed, draw, 40, body), expected, rtol=1e-14, atol=1e-15)


def test_interpreted_and_compiled_give_the_same_bits():
    assert np.array_equal(normal(9, 4, 102), normal(9, 4, 102, body=True))


def test_every_number_has_a_fixed_place():
    long = normal(5, 6, 41)
    for n in range(1, 41):
        assert np.array_equal(normal(5, 6, n), long[:n])


def test_the_extreme_words_give_finite_numbers():
    for fill in (random._fill_pair, random._fill_pair.py_func):
        for a in (0, ALL):
            out = np.zeros(2)
            fill(np.uint64(a), np.uint64(0), out)
            assert out[0] == pytest.approx(0.0 if a else math.sqrt(2 * 53 * math.log(2)))
            assert out[1] == 0.0


def test_the_numbers_are_normal_and_independent():
    n = 100_000
    draws = np.array([normal(seed, draw, n) for seed in (1, 2) for draw in (0, 1)])
    for z in draws:
        assert stats.kstest(z, "norm").pvalue > 1e-3
        # Moments 1 to 4 of n normal numbers have these standard deviations.
        for power, moment, variance in ((1, 0, 1), (2, 1, 2), (3, 0, 15), (4, 3, 96)):
            assert abs((z**power).mean() - moment) < 4 * math.sqrt(variance / n)
        assert abs((z[1:] * z[:-1]).mean()) < 4 / math.sqrt(n)  # neighbours
        assert abs((z[2:] ** 2 * z[:-2] ** 2).mean() - 1) < 4 * math.sqrt(8 / n)
    products = draws @ draws.T / n - np.diag((draws**2).mean(axis=1))
    assert abs(products).max() < 4 / math.sqrt(n)


def test_numbers_that_are_too_wide_or_related_would_be_seen():
    z = normal(1, 0, 100_000)
    assert stats.kstest(1.05 * z, "norm").pvalue < 1e-3
    assert abs((z * (0.98 * normal(1, 1, z.size) + 0.2 * z)).mean()) > 4 / math.sqrt(z.size)
