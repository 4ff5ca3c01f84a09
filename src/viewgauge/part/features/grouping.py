"""Connected groups of features."""

from __future__ import annotations

from collections.abc import Callable, Sequence

__all__ = ["connected_groups"]


def connected_groups(items: Sequence[int], linked: Callable[[int, int], bool]) -> list[list[int]]:
    """The distinct items in groups, two being in one group when a chain of linked items joins them.

    Items within a group and the groups' first items keep the given order.
    """
    left, groups = list(dict.fromkeys(items)), []
    while left:
        group = {left[0]}
        frontier = [left[0]]
        while frontier:
            current = frontier.pop()
            near = [item for item in left if item not in group and linked(current, item)]
            group.update(near)
            frontier += near
        groups.append([item for item in left if item in group])
        left = [item for item in left if item not in group]
    return groups
