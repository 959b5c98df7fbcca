"""Flows in the plane that always approach a goal: v = -P grad Phi, with Phi the distance to the goal.

>>> import numpy as np
>>> from ddl_forecast.dynamics import Flow
>>> flow = Flow(goal=[5.0, 0.0], P=[[1.2, 0.3], [0.3, 0.8]])
>>> path = flow.rollout([0.0, 1.0], dt=0.4, steps=12)
>>> path.shape
(13, 2)
>>> flow.certificate(path, dt=0.4).holds
True
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, floats, unmasked

__all__ = ["Certificate", "Flow"]


@dataclass(frozen=True, eq=False)
class Certificate:
    """Evidence about a path: whether it approaches the goal at each step, along a flow that descends."""

    #: Whether the certificate holds.
    holds: bool
    #: The first violated condition, in words; None if the certificate holds.
    violation: str | None
    #: (steps + 1,) distance to the goal, metres.
    potentials: Floats
    #: Smallest eigenvalue of P along the path, m/s.
    min_eigenvalue: float
    #: Smallest margin between a step and its bound, relative to the bound.
    min_step_margin: float
    #: Largest angle between velocity and direction to the goal, radians.
    largest_angle: float


class Flow:
    """A flow to a goal.

    Parameters
    ----------
    goal
        (2,) metres.
    P
        (2, 2) symmetric positive definite, m/s: the identity is 1 m/s straight to the goal. Or (steps, 2, 2), one
        matrix for each step; further steps use the last one.

    Raises
    ------
    ValueError
        A matrix is not symmetric and positive definite (the message names it), or a number is not finite.
    """

    def __init__(self, goal: ArrayLike, P: ArrayLike) -> None:
        unmasked(P, "P")
        matrices = np.asarray(P, dtype=np.float64)
        if matrices.ndim not in (2, 3) or matrices.shape[-2:] != (2, 2):
            raise ValueError(f"P must have the shape (2, 2) or (steps, 2, 2); found {matrices.shape}")
        at = floats(goal, 1, "goal", "(2,)")
        if at.shape != (2,):
            raise ValueError(f"goal must have the shape (2,); found {at.shape}")
        metrics = np.ascontiguousarray(matrices.reshape(-1, 2, 2))
        self._core = _core.Flow((float(at[0]), float(at[1])), metrics)

    def velocity(self, position: ArrayLike, *, step: int = 0) -> Floats:
        """(2,) or (m, 2) velocities, m/s, at positions of the same shape."""
        single, points = _points(position, "position")
        velocities = self._core.velocity(points, step)
        return velocities[0] if single else velocities

    def rollout(self, start: ArrayLike, *, dt: float = 0.4, steps: int = 12) -> Floats:
        """(steps + 1, 2) positions from a start (2,), or (m, steps + 1, 2) from (m, 2).

        The distance to the goal falls at each step.
        """
        single, points = _points(start, "start")
        paths = self._core.rollout(points, dt, steps)
        return paths[0] if single else paths

    def certificate(self, path: ArrayLike, *, dt: float = 0.4) -> Certificate:
        """The certificate of a path (steps + 1, 2), from any program."""
        return Certificate(**self._core.certificate(floats(path, 2, "path", "(steps + 1, 2)"), dt))


def _points(values: ArrayLike, name: str) -> tuple[bool, Floats]:
    unmasked(values, name)
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim not in (1, 2) or array.shape[-1] != 2:
        raise ValueError(f"{name} must have the shape (2,) or (m, 2); found {array.shape}")
    return array.ndim == 1, array.reshape(-1, 2)
