"""Forecasts."""

from __future__ import annotations

import os
import warnings
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddl_forecast import _core
from ddl_forecast._arrays import Flags, Floats, Integers, plan_rows
from ddl_forecast._core import UNFAMILIAR

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class Certificates:
    """Evidence that every hypothesis approaches its goal at each of the 12 steps.

    It proves that the forecast is stable, not that it is accurate.
    """

    #: (n, k, 13) distances to the goal, metres, from the last observed position on; they fall.
    potentials: Floats
    #: (n, k) smallest eigenvalue of P over the steps; above 0.
    min_eigenvalue: Floats
    #: (n, k) smallest margin between a step and its bound, relative to the bound.
    min_step_margin: Floats
    #: (n, k) largest angle between velocity and direction to the goal, radians; below pi / 2.
    largest_angle: Floats


@dataclass(frozen=True, eq=False)
class Risk:
    """Risk of p plans."""

    #: (p,) probability that somebody comes close.
    total: Floats
    #: (p, n) that each pedestrian does; NaN for those who could not be forecast.
    pedestrians: Floats
    #: (p, 12) that somebody is close during each step of 0.4 s.
    steps: Floats
    #: (p, 12) that somebody was close by the end of each step.
    until: Floats


@dataclass(frozen=True, eq=False)
class Occupancy:
    """Where somebody will be."""

    #: (times, height, width) probabilities; rows along x, the lowest y first.
    probabilities: NDArray[np.float32]
    #: (times,) seconds from now.
    times: Floats
    #: Side of a cell, metres.
    cell: float
    #: (2,) the lowest corner of the area, metres.
    origin: Floats

    def message(self, index: int, frame_id: str = "map") -> dict[str, Any]:
        """The grid of a time as an object with the fields of ``nav_msgs/OccupancyGrid``, in percent.

        ``stamp`` is the time in seconds after the moment.
        """
        grid = self.probabilities[index]
        position = {"x": float(self.origin[0]), "y": float(self.origin[1]), "z": 0.0}
        origin = {"position": position, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
        info = {"resolution": self.cell, "width": grid.shape[1], "height": grid.shape[0], "origin": origin}
        header = {"stamp": float(self.times[index]), "frame_id": frame_id}
        return {"header": header, "info": info, "data": np.rint(100 * grid).astype(int).ravel().tolist()}


class DoubtWarning(UserWarning):
    """The input looks wrong: a unit, a frame rate, positions, or motions unlike the training motions."""


@dataclass(frozen=True, eq=False, repr=False)
class Forecast:
    """k weighted hypotheses of the next 4.8 s for each of n pedestrians.

    ``valid`` is False for pedestrians that cannot be forecast: those not observed now, observed only once, or where
    they cannot be. Their rows are NaN.

    Attributes
    ----------
    paths : (n, k, 12, 2)
        Positions, metres, 0.4 s apart; the first is 0.4 s after the last observation.
    weights : (n, k)
        Probability of each hypothesis; they sum to 1.
    goals : (n, k, 2) or None
        Goal of each hypothesis, metres.
    familiarity : (n,)
        Similarity of the observed motion to the training motions, 0 to 1; below 0.01 a forecast is doubtful.
    certified : (n, k) or None
        Whether each hypothesis provably approaches its goal at each step.
    spread : (n, 12) or None
        Scale of Student's t with 3 degrees of freedom around the right hypothesis, metres.
    past : (n, 8, 2)
        The observed positions 0.4 s apart, metres: rows at these times, otherwise estimated from all rows so far.
    unseen : (n,)
        How many of them lie before the first row: they continue the motion backwards.
    age : (n,)
        Time since the last row, seconds.
    deviation : (n,)
        Estimated standard deviation of the last position, metres; 0 with a row at each step, too small after missing
        rows.
    uncertainty : (n,)
        Standard deviation that the observation adds at the end of the forecast, metres; 0 with a row at every step.
    certificates : Certificates or None
        The evidence, with ``certificates=True``.
    ids, frame, frames, recording
        Ids of the pedestrians, the last observed frame, the 12 forecast frames, and the name of the recording. Frames
        are numbers or times as in the recording; None for arrays.
    joint : bool
        Whether hypothesis k of all pedestrians is one future of the scene, with one weight.
    """

    paths: Floats
    weights: Floats
    goals: Floats | None
    familiarity: Floats
    certified: Flags | None
    spread: Floats | None
    past: Floats
    unseen: Integers
    age: Floats
    deviation: Floats
    uncertainty: Floats
    certificates: Certificates | None = None
    ids: NDArray[Any] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    frame: Any = None
    frames: NDArray[Any] | None = None
    recording: str = ""
    joint: bool = False
    _region_table: str | None = field(default=None, repr=False)
    _futures: _core.Futures | None = field(default=None, repr=False)
    _left_out: int = field(default=0, repr=False)

    @classmethod
    def _of(
        cls,
        parts: dict[str, Any],
        ids: Sequence[Hashable] | None = None,
        *,
        joint: bool = False,
        left_out: int = 0,
    ) -> Forecast:
        evidence = parts.pop("certificates")
        table = parts.pop("region_table")
        futures = parts.pop("futures")
        frames = parts.pop("frames", None)
        named = parts.pop("ids", None)
        names = ids if ids is not None else named
        if names is None:
            names = range(len(parts["paths"]))
        return cls(
            **parts,
            certificates=None if evidence is None else Certificates(**evidence),
            ids=_ids(list(names)),
            frames=frames,
            joint=joint,
            _region_table=table,
            _futures=futures,
            _left_out=left_out,
        )

    def __len__(self) -> int:
        return len(self.paths)

    def __repr__(self) -> str:
        n, k = self.paths.shape[:2]
        frame = "" if self.frame is None else f", observed until frame {self.frame}"
        return f"Forecast({n} pedestrians, {k} hypotheses{frame})"

    def unfamiliar(self) -> str | None:
        """A warning about motions unlike the training motions; None without such motions."""
        few = int(np.count_nonzero(self.familiarity < UNFAMILIAR))
        if few == 0:
            return None
        return (
            f"{few} of {int(self.valid.sum())} motions are unlike the training motions "
            f"(familiarity below {UNFAMILIAR}); check that positions are in metres and steps are 0.4 s. "
            "Forecasts of such motions use little of the network, and their weights are flatter"
        )

    @property
    def valid(self) -> Flags:
        """(n,) whether each pedestrian could be forecast."""
        return ~np.isnan(self.weights[:, 0]) if self.weights.size else np.zeros(len(self.paths), dtype=np.bool_)

    @property
    def futures(self) -> Floats:
        """(k, n, 12, 2) the futures of the scene, metres.

        Raises
        ------
        ValueError
            The forecast is not joint.
        """
        self._ensure_joint()
        futures: Floats = self.paths.transpose(1, 0, 2, 3)
        return futures

    def risk(
        self, plans: Sequence[ArrayLike] | Floats, within: float = 0.5, *, ego: Hashable = None, seen: bool = True
    ) -> Risk:
        """Probabilities that somebody comes within ``within`` metres of plans, during the next 4.8 s.

        Parameters
        ----------
        plans
            (p, m, 3) or a sequence of (m, 3): rows of t in seconds from now, x and y in metres; with a fourth column,
            the radius of whoever follows the plan. Before its first time it is at the first position, after its
            last time at the last position.
        within
            Distance from the edge of a plan, metres.
        ego
            Id of the pedestrian who follows the plans, and is no risk to itself; None: none of them.
        seen
            Whether people see who follows the plan, and keep away as from a pedestrian. Those of a forecast with a plan
            keep away from it already: give False.

        Warns
        -----
        DoubtWarning
            Pedestrians are seen now who could not be forecast: they do not count, and are NaN. A plan is doubtful: its
            speed, its times, its distance from everybody, a radius after 4.8 s.
        """
        scene, rows = self._scene(), self.valid
        if self._left_out > 0:
            words = f"pedestrians who could not be forecast and do not count: {self._left_out}"
            warnings.warn(words, DoubtWarning, stacklevel=2)
        row = None
        if ego is not None:
            found = np.flatnonzero(self.ids[rows] == ego)
            if found.size == 0:
                raise ValueError(f"ego {ego!r} is not among the pedestrians that could be forecast")
            row = int(found[0])
        (total, people, steps, until), doubts = scene.risks(*_plans(plans), within, row, seen)
        for doubt in doubts:
            warnings.warn(doubt, DoubtWarning, stacklevel=2)
        of_each = np.full((len(total), len(self)), np.nan)
        of_each[:, rows] = people
        return Risk(total, of_each, steps, until)

    def nearest(self, plans: Sequence[ArrayLike] | Floats) -> tuple[Floats, Floats]:
        """Expected least distance (m) of plans from everybody (p,), inf without anybody, and each pedestrian (p, n).

        Of people who do not see the plan, as in ``risk(seen=False)``.
        """
        rows = self.valid
        nearest, people = self._scene().clearances(*_plans(plans))
        of_each = np.full((len(nearest), len(self)), np.nan)
        of_each[:, rows] = people
        return nearest, of_each

    def occupancy(
        self,
        cell: float = 0.1,
        *,
        every: float = 0.4,
        area: tuple[float, float, float, float] | None = None,
        margin: float = 1.0,
        radius: float = 0.2,
    ) -> Occupancy:
        """Probability that a pedestrian of this radius covers the middle of each cell, at 0, ``every``, ... 4.8 s.

        Parameters
        ----------
        cell
            Side of a cell, metres.
        every
            Time between two grids, seconds.
        area
            Lowest x and y, largest x and y, metres; default: all paths and ``margin`` around them.

        Warns
        -----
        DoubtWarning
            Pedestrians are too far from the others for the default area of 25 million cells: it leaves them out.
        """
        grids, times, origin, outside = self._scene().occupancy((cell, every, radius, margin), area)
        if outside > 0:
            words = f"pedestrians too far from the others for the area of the grids: {outside}; give area="
            warnings.warn(words, DoubtWarning, stacklevel=2)
        return Occupancy(grids, np.array(times), cell, np.array(origin))

    def _ensure_joint(self) -> None:
        if not self.joint:
            raise ValueError("this forecast is of single pedestrians: make it with joint=True")

    def _scene(self) -> _core.Futures:
        self._ensure_joint()
        if self._futures is None:
            raise ValueError("this forecast has no spread: only the 20 futures of a model have it")
        return self._futures

    def most_likely(self) -> Floats:
        """(n, 12, 2) the path of the hypothesis with the largest weight, metres."""
        heaviest = np.argmax(np.nan_to_num(self.weights, nan=-1.0), axis=1)
        chosen: Floats = self.paths[np.arange(len(self.paths)), heaviest]
        return chosen

    def mean(self) -> Floats:
        """(n, 12, 2) the weighted mean of the hypotheses, metres."""
        mean: Floats = np.einsum("nk,nkts->nts", self.weights, self.paths)
        return mean

    def regions(self, level: float = 0.9, *, of: Literal["step", "path", "scene"] = "step") -> Floats:
        """Radii (n, k, 12) in metres of regions with the probability ``level``.

        With this probability the pedestrian is within the radius of at least one of ``paths``: at one step, at all 12
        (``"path"``), or all pedestrians of the forecast at all 12 (``"scene"``).

        NaN where a hypothesis has no disc. Calibrated on places that the model was not trained on.

        Raises
        ------
        ValueError
            The forecast has no regions (one hypothesis, a baseline), or there is none of this level.
        """
        if self.spread is None or self._region_table is None:
            raise ValueError("this forecast has no regions: only the 20 hypotheses of a model have them")
        observed, wanted = (self.past, self.uncertainty), (level, of)
        return _core.region_radii(observed, self.weights, self.spread, self._region_table, wanted)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Columns of a table, one row per position, for ``pandas.DataFrame`` or ``polars.DataFrame``.

        Columns: observed_until, pedestrian, hypothesis, weight, frame, x, y, goal_x, goal_y, certified. Hypotheses are
        in the order of their weights, the largest first.
        """
        return table([self])

    def plot(self, ax: Axes | None = None, *, level: float | None = None) -> Axes:
        """Draw the scene with matplotlib: pasts, hypotheses by weight, goals.

        With ``level``, also the region of that probability at the horizon.
        """
        from ddl_forecast._plot import draw

        shown = self.valid
        goals = None if self.goals is None else self.goals[shown]
        radii = None if level is None else self.regions(level)[shown, :, -1]
        return draw(
            ax, self.past[shown], self.unseen[shown], self.paths[shown], self.weights[shown], goals, radii, level
        )


def _plans(plans: Sequence[ArrayLike] | Floats) -> tuple[Floats, list[int]]:
    """The rows of all plans, and the number of those of each; one plan alone needs a list around it."""
    if len(plans) > 0 and np.ndim(plans[0]) == 1:
        raise ValueError("plans must be a list of plans, each of the shape (m, 3) or (m, 4): put one plan into a list")
    if isinstance(plans, np.ndarray) and plans.ndim == 3:
        return plan_rows(plans.reshape(plans.shape[0] * plans.shape[1], plans.shape[2])), [plans.shape[1]] * len(plans)
    of_each = [plan_rows(plan) for plan in plans]
    return np.concatenate([np.empty((0, 4)), *of_each]), [len(rows) for rows in of_each]


def _ids(names: list[Any]) -> NDArray[Any]:
    """Numbers or words as an array of their kind, both together as objects."""
    if len({isinstance(name, str) for name in names}) > 1:
        mixed = np.empty(len(names), dtype=object)
        mixed[:] = names
        return mixed
    return np.array(names) if names else np.empty(0, dtype=np.int64)


def table(forecasts: Sequence[Forecast]) -> dict[str, NDArray[Any]]:
    """Columns of several forecasts together."""
    columns: dict[str, list[NDArray[Any]]] = {}
    for forecast in forecasts:
        for name, values in _columns(forecast).items():
            columns.setdefault(name, []).append(values)
    return {name: np.concatenate(parts) for name, parts in columns.items()}


def _columns(forecast: Forecast) -> dict[str, NDArray[Any]]:
    rows = np.flatnonzero(forecast.valid)
    n, (k, steps) = len(rows), forecast.paths.shape[1:3]
    weights = forecast.weights[rows]
    order = np.argsort(-weights, axis=1, kind="stable")

    def each(values: NDArray[Any]) -> NDArray[Any]:
        return np.take_along_axis(values[rows], order.reshape(order.shape + (1,) * (values.ndim - 2)), axis=1)

    def repeated(values: NDArray[Any]) -> NDArray[Any]:
        return np.repeat(values.reshape(-1), steps)

    paths = each(forecast.paths)
    frames = np.arange(1, steps + 1) if forecast.frames is None else forecast.frames
    until = 0 if forecast.frame is None else forecast.frame
    columns: dict[str, NDArray[Any]] = {
        "observed_until": np.full(n * k * steps, until),
        "pedestrian": np.repeat(forecast.ids[rows], k * steps),
        "hypothesis": repeated(np.tile(np.arange(k), (n, 1))),
        "weight": repeated(each(forecast.weights)),
        "frame": np.tile(frames, n * k),
        "x": paths[..., 0].reshape(-1),
        "y": paths[..., 1].reshape(-1),
    }
    if forecast.goals is not None:
        goals = each(forecast.goals)
        columns |= {"goal_x": repeated(goals[..., 0]), "goal_y": repeated(goals[..., 1])}
    if forecast.certified is not None:
        columns["certified"] = repeated(each(forecast.certified))
    return columns


def write_forecasts(path: str | os.PathLike[str], forecasts: Sequence[Forecast]) -> None:
    """Write forecasts as the JSON lines that ``ddl evaluate --forecasts`` reads, with all digits."""
    rows = []
    for forecast in forecasts:
        if forecast.frame is None or not forecast.recording or forecast.ids.dtype.kind not in "iu":
            raise ValueError(
                "only forecasts of recordings with numbered pedestrians can be written, not of arrays or words"
            )
        if not isinstance(forecast.frame, int):
            raise ValueError(f"only forecasts of frame numbers can be written, not of the time {forecast.frame}")
        if forecast.frames is not None and forecast.frames.dtype.kind not in "iu":
            raise ValueError(f"forecasts between two frames, such as {forecast.frames[0]:.2f}, cannot be written")
        keep = forecast.valid
        rows.append(
            (
                forecast.recording,
                forecast.frame,
                [int(one) for one in forecast.ids[keep]],
                np.ascontiguousarray(forecast.past[keep]),
                np.ascontiguousarray(forecast.paths[keep]),
                np.ascontiguousarray(forecast.weights[keep]),
                None if forecast.goals is None else np.ascontiguousarray(forecast.goals[keep]),
            )
        )
    _core.write_forecasts(path, rows)
