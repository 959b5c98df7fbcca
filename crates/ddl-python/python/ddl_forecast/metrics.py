"""Metrics of trajectory forecasts, with the usual definitions.

``paths`` are (n, k, 12, 2) hypotheses and ``truth`` (n, 12, 2) positions, metres; ``weights`` (n, k) sum to 1 for each
pedestrian; the default is 1/k.

>>> import numpy as np
>>> from ddl_forecast import metrics
>>> truth = np.zeros((1, 12, 2))
>>> paths = np.ones((1, 2, 12, 2)) * np.array([3.0, 4.0])
>>> metrics.min_ade(paths, truth).tolist(), metrics.min_fde(paths, truth).tolist()
([5.0], [5.0])
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ddl_forecast import _core
from ddl_forecast._arrays import Flags, Floats, floats

__all__ = [
    "ade",
    "amd",
    "amv",
    "closest_approach",
    "collides",
    "diversity",
    "end_diversity",
    "fde",
    "joint_ade",
    "joint_fde",
    "kde_nll",
    "min_ade",
    "min_fde",
    "miss",
    "scores",
]


def _paths(paths: ArrayLike) -> Floats:
    return floats(paths, 4, "paths", "(n, k, 12, 2)")


def _truth(truth: ArrayLike) -> Floats:
    return floats(truth, 3, "truth", "(n, 12, 2)")


def _weights(weights: ArrayLike | None) -> Floats | None:
    return None if weights is None else floats(weights, 2, "weights", "(n, k)")


def ade(paths: ArrayLike, truth: ArrayLike) -> Floats:
    """(n, k) average displacement error of every hypothesis, metres."""
    return _core.displacement_errors(_paths(paths), _truth(truth))[0]


def fde(paths: ArrayLike, truth: ArrayLike) -> Floats:
    """(n, k) displacement of the last position of every hypothesis, metres."""
    return _core.displacement_errors(_paths(paths), _truth(truth))[1]


def min_ade(paths: ArrayLike, truth: ArrayLike) -> Floats:
    """(n,) smallest ADE of the hypotheses of each pedestrian, metres."""
    least: Floats = ade(paths, truth).min(axis=1)
    return least


def min_fde(paths: ArrayLike, truth: ArrayLike) -> Floats:
    """(n,) smallest FDE of the hypotheses of each pedestrian, metres; not always that of min_ade."""
    least: Floats = fde(paths, truth).min(axis=1)
    return least


def joint_ade(paths: ArrayLike, truth: ArrayLike) -> float:
    """JADE: ADE of the best joint future of the scene, hypothesis k of all pedestrians, metres."""
    return float(ade(paths, truth).mean(axis=0).min())


def joint_fde(paths: ArrayLike, truth: ArrayLike) -> float:
    """JFDE: FDE of the best joint future of the scene, metres."""
    return float(fde(paths, truth).mean(axis=0).min())


def miss(paths: ArrayLike, truth: ArrayLike, *, distance: float = 2.0) -> Flags:
    """(n,) whether every hypothesis ends further than ``distance`` metres from the truth; the mean is the miss rate."""
    if not distance >= 0:
        raise ValueError(f"distance is {distance}; it must be a number of metres, 0 or more")
    missed: Flags = min_fde(paths, truth) > distance
    return missed


def kde_nll(paths: ArrayLike, truth: ArrayLike, weights: ArrayLike | None = None) -> Floats:
    """(n,) negative log-likelihood of the truth under a kernel density of the hypotheses, nats.

    The log-likelihood of a step counts as at least -20.
    """
    return _core.kde_nll(_paths(paths), _truth(truth), _weights(weights))


def amd(paths: ArrayLike, truth: ArrayLike, weights: ArrayLike | None = None) -> Floats:
    """(n,) average Mahalanobis distance of the truth from the hypotheses, standard deviations."""
    return _core.mahalanobis(_paths(paths), _truth(truth), _weights(weights))[0]


def amv(paths: ArrayLike, weights: ArrayLike | None = None) -> float:
    """Average maximum eigenvalue: variance of the hypotheses along their widest axis, square metres."""
    array = _paths(paths)
    covariances = _core.mahalanobis(array, np.ascontiguousarray(array[:, 0]), _weights(weights))[1]
    xx, xy, yy = covariances.mean(axis=0)
    return float(np.linalg.eigvalsh(np.array([[xx, xy], [xy, yy]]))[-1])


def diversity(paths: ArrayLike) -> Floats:
    """(n,) mean distance between the paths of two hypotheses, metres."""
    return _core.spread_between(_paths(paths))[0]


def end_diversity(paths: ArrayLike) -> Floats:
    """(n,) mean distance between the endpoints of two hypotheses, metres."""
    return _core.spread_between(_paths(paths))[1]


def collides(paths: ArrayLike, *, radius: float = 0.2) -> Flags:
    """(n,) whether each of (n, t, 2) paths comes within two radii (metres) of another, also between steps."""
    return _core.collisions(floats(paths, 3, "paths", "(n, t, 2)"), radius)[0]


def closest_approach(paths: ArrayLike) -> Floats:
    """(n,) smallest distance of each of (n, t, 2) paths to any other at the same time, metres."""
    return _core.collisions(floats(paths, 3, "paths", "(n, t, 2)"), 0.2)[1]


def scores(
    paths: Floats | Sequence[ArrayLike],
    truth: Floats | Sequence[ArrayLike],
    past: Floats | Sequence[ArrayLike],
    *,
    weights: ArrayLike | Sequence[ArrayLike] | None = None,
    goals: ArrayLike | Sequence[ArrayLike] | None = None,
) -> dict[str, Any]:
    """All scores of a scene, or of a list of scenes: means over pedestrians.

    ``past`` (n, 8, 2) is needed to classify the motions. The keys are those of ``report.json``, the fields of
    `ddl_eval::Scores`.
    """
    one = np.ndim(paths[0]) == 3 if len(paths) else False

    def each(values: Any) -> list[Any]:
        return [values] if one else list(values)

    made = [_paths(of) for of in each(paths)]
    given_weights = [None] * len(made) if weights is None else each(weights)
    given_goals = [None] * len(made) if goals is None else each(goals)
    text = _core.scores(
        made,
        [_truth(of) for of in each(truth)],
        [floats(of, 3, "past", "(n, 8, 2)") for of in each(past)],
        [_weights(of) for of in given_weights],
        [None if of is None else floats(of, 3, "goals", "(n, k, 2)") for of in given_goals],
    )
    result: dict[str, Any] = json.loads(text)
    return result
