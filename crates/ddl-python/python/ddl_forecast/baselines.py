"""Baselines: forecasts that need no training.

Each takes (n, 8, 2) observed positions in metres, NaN where a pedestrian was not observed, and returns a
:class:`ddl_forecast.Forecast` of one hypothesis (``angular_noise``: 20).

>>> import numpy as np
>>> from ddl_forecast import baselines
>>> past = np.stack([np.linspace([0, 0], [3.5, 0], 8)])
>>> baselines.constant_velocity(past).paths[0, 0, -1].tolist()
[9.5, 0.0]
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from ddl_forecast import _core
from ddl_forecast._arrays import floats, scene
from ddl_forecast._forecast import Forecast

__all__ = [
    "angular_noise",
    "constant_acceleration",
    "constant_velocity",
    "mean_velocity",
    "social_force",
    "straight_line",
]


def _baseline(name: str, past: ArrayLike, seed: int = 0, goals: ArrayLike | None = None) -> Forecast:
    array, asked = scene(past, None)
    ends = None if goals is None else floats(goals, 3, "goals", "(n, k, 2)")
    return Forecast._of(_core.baseline(name, array, asked, seed, ends))


def constant_velocity(past: ArrayLike) -> Forecast:
    """Constant velocity, that of the last step."""
    return _baseline("constant_velocity", past)


def mean_velocity(past: ArrayLike) -> Forecast:
    """Constant velocity, the mean of the observation."""
    return _baseline("mean_velocity", past)


def angular_noise(past: ArrayLike, *, seed: int = 0) -> Forecast:
    """20 hypotheses: the velocity of the last step, rotated at random (Schoeller et al., RA-L 2020)."""
    return _baseline("angular_noise", past, seed)


def constant_acceleration(past: ArrayLike) -> Forecast:
    """Constant acceleration, that of the last steps, within the limits of pedestrians."""
    return _baseline("constant_acceleration", past)


def social_force(past: ArrayLike) -> Forecast:
    """The social force model (Helbing & Molnar 1995), with constant velocity as the desired velocity."""
    return _baseline("social_force", past)


def straight_line(past: ArrayLike, goals: ArrayLike) -> Forecast:
    """Straight lines at constant speed that reach (n, k, 2) goals, metres, in 4.8 s."""
    return _baseline("straight_line", past, goals=goals)
