"""In-place sorting, so that results of tree queries are in an order that does not depend on the tree."""

from typing import Any

from kickdrift.core.compilation import compiled


@compiled
def sort(numbers: Any, count: int) -> None:
    """Sort the first `count` numbers of an array, usually few: Shell's method with Knuth's gaps, n^1.5 steps at worst."""
    gap = 1
    while 3 * gap < count:
        gap = 3 * gap + 1
    while gap > 0:
        for k in range(gap, count):
            value, place = numbers[k], k
            while place >= gap and numbers[place - gap] > value:
                numbers[place] = numbers[place - gap]
                place -= gap
            numbers[place] = value
        gap //= 3
