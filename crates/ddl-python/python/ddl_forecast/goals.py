"""Goals from similar tracks: the endpoints of pedestrians that moved alike.

:meth:`ddl_forecast.Forecaster.goals` gives the goals of a trained model; this is the estimator alone, for own tracks.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, floats

__all__ = ["GoalEstimator"]


class GoalEstimator:
    """Finds the tracks with the most similar beginnings, and clusters their endpoints into a few goals.

    Similarity is the distance of velocities in the frame of the heading; mirror images count too.

    Parameters
    ----------
    experts
        (m, 20, 2) whole tracks, metres, 0.4 s apart.
    similar
        Number of similar tracks to use.
    goals
        Number of goals for each pedestrian.

    Examples
    --------
    >>> import numpy as np
    >>> speeds = np.linspace(0.5, 1.5, 60)
    >>> experts = np.stack([np.linspace([0, 0], [7.6 * speed, 0.3 * speed], 20) for speed in speeds])
    >>> estimator = GoalEstimator(experts, similar=10, goals=3)
    >>> goals, weights = estimator.estimate(experts[30:31, :8])
    >>> goals.shape, bool(np.isclose(weights.sum(), 1.0))
    ((1, 3, 2), True)
    """

    def __init__(self, experts: ArrayLike, *, similar: int = 800, goals: int = 20) -> None:
        tracks = floats(experts, 3, "experts", "(m, 20, 2)")
        self._core = _core.GoalEstimator(tracks, similar=similar, goals=goals)

    def __len__(self) -> int:
        return len(self._core)

    def estimate(self, past: ArrayLike) -> tuple[Floats, Floats]:
        """(n, goals, 2) positions in 4.8 s, metres, and (n, goals) weights, from (n, 8, 2) observed positions."""
        return self._core.estimate(floats(past, 3, "past", "(n, 8, 2)"))
