"""Soft-DTW: value, gradient, and exact nearest-neighbour search (Cuturi & Blondel, ICML 2017).

A sequence is an array (steps, components) of up to 128 components, or (steps,). Contiguous sequences of float64 are not
copied.

>>> import numpy as np
>>> from ddl_forecast import soft_dtw
>>> x, y = np.array([[0.0], [0.0], [1.0]]), np.array([[0.0], [1.0], [1.0]])
>>> soft_dtw.value(x, y, gamma=0)  # hard DTW: one shape at two speeds
0.0
>>> distance, gradient = soft_dtw.value_and_gradient(x, y, gamma=1.0)
>>> gradient.shape
(3, 1)
"""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, Integers
from ddl_forecast._core import value, value_and_gradient

__all__ = ["SearchIndex", "value", "value_and_gradient"]


class SearchIndex:
    """An index of candidates for repeated searches, by the normalised distance.

    It is ``value(x, y) - (value(x, x) + value(y, y)) / 2``: 0 for equal sequences.

    Parameters
    ----------
    candidates
        Sequences of any lengths, with the same number of components.
    gamma
        As for :func:`value`.

    Examples
    --------
    >>> import numpy as np
    >>> walks = [np.cumsum(np.full((20, 2), speed), axis=0) for speed in (0.1, 0.3, 0.5)]
    >>> index = SearchIndex(walks)
    >>> indices, distances = index.nearest(walks[1] + 0.01, n=2)
    >>> int(indices[0]), distances.shape
    (1, (2,))
    """

    def __init__(self, candidates: Sequence[ArrayLike], gamma: float = 1.0) -> None:
        self._core = _core.SearchIndex(list(candidates), gamma)

    def __len__(self) -> int:
        return len(self._core)

    def nearest(self, query: ArrayLike, n: int = 1) -> tuple[Integers, Floats]:
        """Indices (n,) and distances (n,) of the candidates nearest to one sequence, nearest first."""
        indices, distances = self._core.nearest([query], n)
        return indices[0], distances[0]

    def nearest_all(self, queries: Sequence[ArrayLike], n: int = 1) -> tuple[Integers, Floats]:
        """Indices (q, n) and distances (q, n) for each of q sequences, on all threads."""
        return self._core.nearest(list(queries), n)
