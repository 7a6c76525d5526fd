"""Sorting in place, for compiled code: whatever a tree finds is put into an order that does not depend on the tree."""

from typing import Any

from kickdrift.core.compilation import compiled


@compiled
def sort(numbers: Any, count: int) -> None:
    """Sort the first numbers of an array: heapsort, which needs no memory and at worst n log n steps."""
    for start in range(count // 2 - 1, -1, -1):
        _sift(numbers, start, count)
    for end in range(count - 1, 0, -1):
        numbers[0], numbers[end] = numbers[end], numbers[0]
        _sift(numbers, 0, end)


@compiled
def _sift(numbers: Any, root: int, end: int) -> None:
    """Let a number sink until none below it is greater."""
    value = numbers[root]
    child = 2 * root + 1
    while child < end:
        if child + 1 < end and numbers[child + 1] > numbers[child]:
            child += 1
        if numbers[child] <= value:
            break
        numbers[root] = numbers[child]
        root, child = child, 2 * child + 1
    numbers[root] = value
