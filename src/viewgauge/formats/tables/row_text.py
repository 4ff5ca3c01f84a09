"""Lines of CSV from columns, compiled: a few million cells a second, where Python's ``repr`` makes one.

A number is written with the fewest digits that tell it from its neighbours, as ``repr`` writes it. They are found by
the algorithm Schubfach (R. Giulietti, *The Schubfach way to render doubles*, 2020): the interval of numbers that round
to a double, times a power of ten 10^-k such that it holds at most a few integers, computed with 128 bits of the power.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["row_lines"]

_compiled: Callable[[Any], Any] = numba.njit(cache=True, nogil=True)

_LEAST_POWER, _GREATEST_POWER = -292, 324
_LONGEST_NUMBER = 25  # bytes: -2.2250738585072014e-308 is 24


def _powers_of_ten() -> NDArray[np.uint64]:
    """``(617, 2)``: the leading 128 bits of 10^k, rounded up, high and low word."""
    words = []
    for k in range(_LEAST_POWER, _GREATEST_POWER + 1):
        shift = 127 - ((k * 1741647) >> 19)  # 127 - floor(k log2 10)
        if k >= 0:
            power = 10**k << shift if shift >= 0 else -((-(10**k)) >> -shift)
        else:
            power = -((-(1 << shift)) // 10**-k)
        words.append((power >> 64, power & (2**64 - 1)))
    return np.array(words, dtype=np.uint64)


_POWERS = _powers_of_ten()
_0, _1, _2, _4, _10, _40 = (np.uint64(number) for number in (0, 1, 2, 4, 10, 40))
_32, _LOW = np.uint64(32), np.uint64(2**32 - 1)
_FRACTION = np.uint64(2**52 - 1)
_HIDDEN = np.uint64(2**52)
_SIZE, _INFINITY = np.uint64(2**63 - 1), np.uint64(0x7FF << 52)


def row_lines(
    viewpoints: Sequence[bytes],
    characteristics: Sequence[bytes],
    columns: Sequence[NDArray[np.float64] | tuple[NDArray[np.integer], Sequence[bytes]]],
) -> bytes:
    """Lines ``viewpoint,characteristic,cell,...`` for each of m viewpoints and D characteristics, viewpoint by
    viewpoint.

    Parameters
    ----------
    viewpoints, characteristics
        Their cells.
    columns
        Each ``(m D,)``: numbers, NaN for an empty cell, or indices with the cells that they stand for.
    """
    if not viewpoints or not characteristics:
        return b""
    pairs = len(viewpoints) * len(characteristics)
    numbers = [column for column in columns if isinstance(column, np.ndarray)]
    texts = [column for column in columns if not isinstance(column, np.ndarray)]
    is_number = np.array([isinstance(column, np.ndarray) for column in columns], dtype=np.bool_)
    cells = [list(viewpoints), list(characteristics), *(list(names) for _, names in texts)]
    first = np.cumsum([0, *(len(names) for names in cells)])
    flat = [cell for names in cells for cell in names]
    ends = np.cumsum([0, *map(len, flat)])
    width = sum(max(map(len, names)) for names in cells) + _LONGEST_NUMBER * len(numbers) + len(columns) + 2
    out = np.empty(pairs * width, dtype=np.uint8)
    length = _write_rows(
        out,
        np.frombuffer(b"".join(flat) or b" ", dtype=np.uint8),
        ends,
        first,
        len(viewpoints),
        len(characteristics),
        is_number,
        np.array(numbers, dtype=float).reshape(len(numbers), pairs).view(np.uint64),
        np.array([index for index, _ in texts], dtype=np.int64).reshape(len(texts), pairs),
        _POWERS,
    )
    return out[:length].tobytes()


@_compiled
def _write_rows(out, cells, ends, first, viewpoints, characteristics, is_number, numbers, indices, powers):  # type: ignore[no-untyped-def]
    at = 0
    for row in range(viewpoints * characteristics):
        at = _write_cell(out, at, cells, ends, first[0] + row // characteristics)
        out[at] = 44  # a comma
        at = _write_cell(out, at + 1, cells, ends, first[1] + row % characteristics)
        number = text = 0
        for column in range(len(is_number)):
            out[at] = 44
            at += 1
            if is_number[column]:
                at = _write_number(out, at, numbers[number, row], powers)
                number += 1
            else:
                at = _write_cell(out, at, cells, ends, first[2 + text] + indices[text, row])
                text += 1
        out[at] = 10
        at += 1
    return at


@_compiled
def _write_cell(out, at, cells, ends, cell):  # type: ignore[no-untyped-def]
    for source in range(ends[cell], ends[cell + 1]):
        out[at] = cells[source]
        at += 1
    return at


@_compiled
def _write_number(out, at, bits, powers):  # type: ignore[no-untyped-def]
    size = bits & _SIZE
    if size > _INFINITY:  # not a number
        return at
    if size != bits:
        out[at] = 45
        at += 1
    if size == _INFINITY:
        out[at], out[at + 1], out[at + 2] = 105, 110, 102
        return at + 3
    if size == _0:
        out[at], out[at + 1], out[at + 2] = 48, 46, 48
        return at + 3
    digits, exponent = _shortest(size, powers)
    while digits % 10 == 0:
        digits //= 10
        exponent += 1
    count, rest = 0, digits
    while rest:
        rest //= 10
        count += 1
    point = count + exponent  # the number is 0.digits times 10^point
    if -4 < point <= 16:
        return _write_fixed(out, at, digits, count, point)
    return _write_scientific(out, at, digits, count, point - 1)


@_compiled
def _write_fixed(out, at, digits, count, point):  # type: ignore[no-untyped-def]
    if point <= 0:
        out[at], out[at + 1] = 48, 46
        for zero in range(-point):
            out[at + 2 + zero] = 48
        return _write_digits(out, at + 2 - point, digits, count)
    if point < count:
        tail = 1
        for _ in range(count - point):
            tail *= 10
        at = _write_digits(out, at, digits // tail, point)
        out[at] = 46
        return _write_digits(out, at + 1, digits % tail, count - point)
    at = _write_digits(out, at, digits, count)
    for zero in range(point - count):
        out[at + zero] = 48
    at += point - count
    out[at], out[at + 1] = 46, 48
    return at + 2


@_compiled
def _write_scientific(out, at, digits, count, exponent):  # type: ignore[no-untyped-def]
    end = _write_digits(out, at + 1, digits, count)
    out[at] = out[at + 1]
    out[at + 1] = 46
    at = end if count > 1 else at + 1
    out[at] = 101
    out[at + 1] = 45 if exponent < 0 else 43
    size = abs(exponent)
    return _write_digits(out, at + 2, size, 3 if size > 99 else 2)


@_compiled
def _write_digits(out, at, digits, count):  # type: ignore[no-untyped-def]
    for place in range(count - 1, -1, -1):
        out[at + place] = 48 + digits % 10
        digits //= 10
    return at + count


@_compiled
def _shortest(bits, powers):  # type: ignore[no-untyped-def]
    """``(d, k)``: the fewest digits d such that d 10^k rounds to a positive double, and the nearest to it of those.

    The number is c 2^q; its neighbours' midpoints are (4 c -+ 2) 2^(q-2), the lower one nearer at a power of two.
    """
    fraction, biased = bits & _FRACTION, np.int64(bits >> np.uint64(52))
    c, q = (fraction | _HIDDEN, biased - 1075) if biased else (fraction, np.int64(-1074))
    if -53 < q <= 0 and c & ((_1 << np.uint64(-q)) - _1) == _0:
        return np.int64(c >> np.uint64(-q)), np.int64(0)
    closer = fraction == _0 and biased > 1
    odd = c & _1
    k = (q * 1262611 - (524031 if closer else 0)) >> 22  # floor(log10) of the interval's width
    h = np.uint64(q + ((-k * 1741647) >> 19) + 1)
    high, low = powers[-k - _LEAST_POWER, 0], powers[-k - _LEAST_POWER, 1]
    lower = _round_to_odd(high, low, (_4 * c - (_1 if closer else _2)) << h) + odd
    middle = _round_to_odd(high, low, (_4 * c) << h)
    upper = _round_to_odd(high, low, (_4 * c + _2) << h) - odd
    s = middle // _4
    if s >= _10:
        tens = s // _10
        below, above = lower <= _40 * tens, _40 * tens + _40 <= upper
        if below != above:
            return np.int64(tens + _1 if above else tens), k + 1
    below, above = lower <= _4 * s, _4 * s + _4 <= upper
    if below != above:
        return np.int64(s + _1 if above else s), k
    half = _4 * s + _2
    up = middle > half or (middle == half and s & _1 == _1)
    return np.int64(s + _1 if up else s), k


@_compiled
def _round_to_odd(high, low, c):  # type: ignore[no-untyped-def]
    """The high 64 of the 192 bits of a 128-bit number times c; the last is 1 if any that is cut off counts."""
    carried = _high_product(low, c)
    cut = high * c
    total = cut + carried
    result = _high_product(high, c)
    if total < cut:
        result += _1
    return result | (_1 if total > _1 else _0)


@_compiled
def _high_product(a, b):  # type: ignore[no-untyped-def]
    """The high 64 bits of a product."""
    a_high, a_low, b_high, b_low = a >> _32, a & _LOW, b >> _32, b & _LOW
    middle = a_high * b_low + ((a_low * b_low) >> _32)
    other = (middle & _LOW) + a_low * b_high
    return a_high * b_high + (middle >> _32) + (other >> _32)
