"""What planning is tested with: small tables of what each viewpoint measures."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp


@st.composite
def acceptances(draw):
    """Viewpoints x characteristics, every characteristic held by some viewpoint; with doubles, parts of others, empty
    rows.
    """
    rows, columns = draw(st.integers(1, 7)), draw(st.integers(0, 7))
    accepted = draw(hnp.arrays(bool, (rows, columns)))
    for j in range(columns):
        accepted[draw(st.integers(0, rows - 1)), j] |= not accepted[:, j].any()
    if draw(st.booleans()):
        k = draw(st.integers(0, rows - 1))
        part = accepted[k] & draw(hnp.arrays(bool, (columns,)))
        accepted = np.vstack([accepted, accepted[k], part, np.zeros(columns, dtype=bool)])
        accepted = accepted[draw(st.permutations(range(len(accepted))))]
    return accepted


@st.composite
def level_tables(draw):
    """Levels, with ties and the ends of the range, every characteristic above 0 somewhere."""
    rows, columns = draw(st.integers(1, 7)), draw(st.integers(0, 6))
    few = st.sampled_from([0, 0, 1, 2, 9000, 9999, 10000])
    level = draw(hnp.arrays(np.uint16, (rows, columns), elements=few | st.integers(0, 10000)))
    for j in range(columns):
        if not level[:, j].any():
            level[draw(st.integers(0, rows - 1)), j] = draw(st.integers(1, 10000))
    return level


@st.composite
def streamed_levels(draw, most_rows=9, most_columns=5):
    """Index, levels and certainty of viewpoints: few levels, so that rows often dominate or equal each other.

    Sometimes spread over more than 64 columns, the others all zero or all alike.
    """
    rows, columns = draw(st.integers(0, most_rows)), draw(st.integers(0, most_columns))
    level = draw(hnp.arrays(np.uint16, (rows, columns), elements=st.sampled_from([0, 1, 2, 9000, 10000])))
    certain = draw(hnp.arrays(bool, (rows, columns), elements=st.sampled_from([True, True, True, False])))
    for k in range(1, rows):
        if draw(st.booleans()):  # a part of the row before, or the same
            level[k] = np.minimum(level[k], level[k - 1]) if draw(st.booleans()) else level[k - 1]
    index = np.array(draw(st.permutations(range(3, 3 + 2 * rows, 2))), dtype=np.int64)
    if columns and draw(st.booleans()):
        at = draw(st.lists(st.integers(0, 139), min_size=columns, max_size=columns, unique=True))
        wide = np.full((rows, 140), draw(st.sampled_from([0, 7])), dtype=np.uint16)
        sure = np.ones((rows, 140), dtype=bool)
        wide[:, at], sure[:, at] = level, certain
        level, certain = wide, sure
    return index, level, certain
