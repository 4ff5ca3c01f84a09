"""Depth-first search for a cover of few rows, on bit sets, compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np

__all__ = ["descend"]

_compiled: Callable[[Any], Any] = numba.njit(cache=True, nogil=True)


@_compiled
def descend(
    rows: Any, everything: Any, holders: Any, ends: Any, byte_prices: Any, paid: Any, most: int, steps: int
) -> Any:
    """Rows of a cover of at most ``most`` rows (none if not found), and whether the search came to its end.

    ``rows`` ``(n, words)`` bit sets; ``holders[ends[j]:ends[j + 1]]`` the rows that hold column j, the dearest first;
    ``byte_prices`` ``(8 words, 256)`` what the columns in a byte of the bit set cost together; ``paid`` ``(n,)`` the
    prices of the rows; ``steps`` the number of rows that may be tried.
    """
    words, dearest = rows.shape[1], paid.max()
    left = np.zeros((most + 1, words), np.uint64)
    left[0] = everything
    branches = np.zeros((most, rows.shape[0]), np.int64)
    count, turn = np.zeros(most, np.int64), np.zeros(most, np.int64)
    over = np.zeros(rows.shape[0], np.bool_)
    depth, fresh = 0, True
    while depth >= 0:
        allowed = most - depth - 1  # rows beside the one chosen here
        if fresh:
            column = _first_bit(left[depth])
            count[depth], tried = _branch(
                rows, left[depth], holders[ends[column] : ends[column + 1]], over, byte_prices, paid, allowed * dearest,
                branches[depth],
            )  # fmt: skip
            steps -= tried
            if steps < 0:
                return branches[0, :0].copy(), False
            turn[depth], fresh = 0, False
        elif turn[depth] > 0:
            over[branches[depth, turn[depth] - 1]] = True
        if turn[depth] == count[depth]:
            for k in range(count[depth]):
                over[branches[depth, k]] = False
            depth -= 1
            continue
        row = branches[depth, turn[depth]]
        turn[depth] += 1
        empty = True
        for w in range(words):
            left[depth + 1, w] = left[depth, w] & ~rows[row, w]
            empty &= left[depth + 1, w] == 0
        if empty:
            path = np.zeros(depth + 1, np.int64)
            for k in range(depth + 1):
                path[k] = branches[k, turn[k] - 1]
            return path, True
        if allowed > 0:
            depth, fresh = depth + 1, True
    return branches[0, :0].copy(), True


@_compiled
def _branch(
    rows: Any, left: Any, holders: Any, over: Any, byte_prices: Any, paid: Any, budget: int, branches: Any
) -> Any:
    """Put the rows whose remainder the budget pays for into ``branches``, the cheapest remainder first.

    Returns their number and how many rows were tried. Without a budget one row that leaves nothing is enough.
    """
    least = _price(left, byte_prices) - budget  # a row takes off at most its own price
    prices = np.empty(holders.size if budget > 0 else 0, np.int64)
    rest = np.empty_like(left)
    count, tried = 0, 0
    for row in holders:
        if paid[row] < least:
            break
        tried += 1
        if over[row]:
            continue
        if budget > 0:
            for w in range(left.size):
                rest[w] = left[w] & ~rows[row, w]
            price = _price(rest, byte_prices)
            if price <= budget:
                branches[count], prices[count] = row, price
                count += 1
        elif _part_of(left, rows[row]):
            branches[0] = row
            return 1, tried
    if budget > 0:
        branches[:count] = branches[:count][np.argsort(prices[:count], kind="mergesort")]
    return count, tried


@_compiled
def _price(words: Any, byte_prices: Any) -> Any:
    price = np.int64(0)
    for w in range(words.size):
        for byte in range(8):
            price += byte_prices[8 * w + byte, (words[w] >> np.uint64(8 * byte)) & np.uint64(255)]
    return price


@_compiled
def _part_of(words: Any, others: Any) -> bool:
    for w in range(words.size):  # noqa: SIM110 # numba's loop is the fast one
        if words[w] & ~others[w]:
            return False
    return True


@_compiled
def _first_bit(words: Any) -> int:
    for w in range(words.size):
        if words[w] != 0:
            bit = 64 * w
            word = words[w]
            while word & np.uint64(1) == 0:
                word >>= np.uint64(1)
                bit += 1
            return bit
    return -1
