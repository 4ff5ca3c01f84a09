"""What each characteristic is worth to a smaller plan: the dual of the linear relaxation of the set cover."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["characteristic_prices"]

_OF_ITS_OWN = 2.0
"""What a characteristic costs that no viewpoint measures: more than a viewpoint, so that one is sought."""


def characteristic_prices(holds: NDArray[np.bool_]) -> tuple[NDArray[np.float64], float]:
    """Prices ``(d,)`` of the characteristics, and their sum: the least number of viewpoints, fractions allowed.

    No viewpoint holds characteristics worth more than 1 together; a new one that does is what can make a plan smaller
    (column generation: Desrosiers and Lübbecke, *A Primer in Column Generation*, 2005).

    Parameters
    ----------
    holds
        ``(m, d)``: which viewpoint measures which characteristic.
    """
    from scipy.optimize import linprog  # slow to import
    from scipy.sparse import csr_array, eye_array, hstack

    rows, columns = holds.shape
    own = np.full(columns, _OF_ITS_OWN)
    result = linprog(
        np.concatenate([np.ones(rows), own]),
        A_ub=hstack([csr_array(-holds.T.astype(float)), -eye_array(columns)], format="csr"),
        b_ub=-np.ones(columns),
        method="highs-ds",
    )
    if result.x is None:
        return np.zeros(columns), 0.0
    return np.maximum(-result.ineqlin.marginals, 0.0), float(result.fun)
