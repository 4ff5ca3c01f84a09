"""What planning is tested with: small tables of what each setting measures."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp


@st.composite
def acceptances(draw):
    """Settings x dimensions, every dimension held by some setting; with doubles, parts of others, empty rows."""
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
def probability_tables(draw):
    """Probabilities, with ties and values equal to the required one, which every dimension reaches somewhere."""
    rows, columns = draw(st.integers(1, 7)), draw(st.integers(0, 6))
    required = draw(st.sampled_from([0.5, 0.9, 0.95]))
    few = st.sampled_from([0.0, 0.3, required, np.nextafter(required, 0), 0.96, 0.97, 0.99, 1.0])
    probability = draw(hnp.arrays(float, (rows, columns), elements=few | st.floats(0, 1)))
    for j in range(columns):
        if probability[:, j].max() < required:
            probability[draw(st.integers(0, rows - 1)), j] = draw(st.floats(required, 1))
    return probability, required
