"""The compiled module. It takes contiguous arrays of float64 or int64."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddl_forecast._arrays import Flags, Floats, Integers

__all__ = [
    "Flow",
    "Futures",
    "GoalEstimator",
    "Live",
    "Model",
    "Recording",
    "SearchIndex",
    "TestSet",
    "UNFAMILIAR",
    "__version__",
    "baseline",
    "collisions",
    "conventions",
    "displacement_errors",
    "evaluate_model",
    "kde_nll",
    "mahalanobis",
    "main",
    "region_radii",
    "report",
    "scores",
    "set_num_threads",
    "spread_between",
    "value",
    "value_and_gradient",
    "windows",
    "write_forecasts",
]
__version__: str
UNFAMILIAR: float

_Path = str | os.PathLike[str]

def main(arguments: list[str]) -> int: ...
def set_num_threads(threads: int) -> None:
    """Set the number of threads. The default is the number of cores, or RAYON_NUM_THREADS."""

@final
class Model:
    @staticmethod
    def open(name: _Path) -> Model: ...
    @staticmethod
    def builtin_names() -> list[str]: ...
    @property
    def hypotheses(self) -> int: ...
    @property
    def parameter_count(self) -> int: ...
    @property
    def trained_on(self) -> tuple[str, str]: ...
    def forecast(
        self,
        past: Sequence[Floats],
        asked: Sequence[int],
        samples: int,
        whole: bool,
        certificates: bool,
        joint: bool,
        given: tuple[Floats, int | None] | None,
    ) -> tuple[list[dict[str, Any]], list[str]]: ...
    def forecast_recording(
        self,
        recording: Recording,
        last: bool,
        samples: int,
        whole: bool,
        max_age: float | None,
        every: float | None,
        certificates: bool,
        joint: bool,
    ) -> tuple[list[dict[str, Any]], str | None]: ...
    def goals(self, past: Floats, asked: int) -> tuple[Floats, Floats]: ...
    def was_trained_on(self, recording: Recording) -> bool: ...
    def page(self, recording: Recording, most: int, joint: bool) -> tuple[str, str | None]: ...

@final
class Recording:
    def __new__(
        cls,
        frame: Integers,
        unit: str | None,
        id: Integers,
        x: Floats,
        y: Floats,
        words: list[str] | None,
        fps: float | None,
        frame_step: int | None,
        name: str,
    ) -> Recording: ...
    @staticmethod
    def read(
        path: _Path,
        *,
        format: str | None = None,
        rate: tuple[float | None, int | None] = ...,
        homography: list[list[float]] | None = None,
        choice: tuple[str | None, str | None, str | None] = ...,
    ) -> Recording: ...
    def write(self, path: _Path, *, format: str = "table") -> None: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def name(self) -> str: ...
    @property
    def frame_step(self) -> float: ...
    @property
    def fps(self) -> float | None: ...
    @property
    def unit(self) -> str | None: ...
    def __len__(self) -> int: ...
    def numbers(self) -> Integers: ...
    def columns(self) -> tuple[NDArray[Any], ArrayLike, Floats, Floats]: ...
    def doubt(self) -> str | None: ...

@final
class Futures:
    def risks(
        self, rows: Floats, lengths: list[int], within: float, ego: int | None, seen: bool
    ) -> tuple[tuple[Floats, Floats, Floats, Floats], list[str]]: ...
    def clearances(self, rows: Floats, lengths: list[int]) -> tuple[Floats, Floats]: ...
    def occupancy(
        self, options: tuple[float, float, float, float], area: tuple[float, float, float, float] | None
    ) -> tuple[NDArray[np.float32], list[float], list[float], int]: ...
    @staticmethod
    def of_json(json: str | None, is_given: bool) -> Futures: ...

@final
class Live:
    def __new__(
        cls,
        model: Model,
        fps: float | None,
        memory: _Path | None,
        whole: bool,
        max_age: float | None,
        every: float,
        certificates: bool,
        joint: bool,
    ) -> Live: ...
    def observe(
        self, frame: int, unit: str | None, ids: Integers, xy: Floats, words: Mapping[int, str]
    ) -> tuple[dict[str, Any] | None, list[tuple[int, float, str]], str | None]: ...
    def clear(self) -> None: ...
    def remembered(self) -> int: ...
    def refused(self) -> str | None: ...
    def close(self) -> str | None: ...

def region_radii(
    observed: tuple[Floats, Floats], weights: Floats, spread: Floats, region_table: str, wanted: tuple[float, str]
) -> Floats: ...
def write_forecasts(
    path: _Path, forecasts: Sequence[tuple[str, int, list[int], Floats, Floats, Floats, Floats | None]]
) -> None: ...
def value(
    x: ArrayLike,
    y: ArrayLike,
    gamma: float = 1.0,
    *,
    normalised: bool = False,
) -> float:
    """Soft-DTW of two sequences.

    Parameters
    ----------
    x, y
        (n, components) and (m, components), or (n,) and (m,).
    gamma
        Smoothing, in the unit of the squared distance of two steps; 0 is hard DTW.
    normalised
        D(x, y) - (D(x, x) + D(y, y)) / 2, which is 0 for x = y.

    Raises
    ------
    ValueError
        A sequence is empty or not finite, or the components differ.
    """

def value_and_gradient(
    x: ArrayLike,
    y: ArrayLike,
    gamma: float = 1.0,
    *,
    normalised: bool = False,
) -> tuple[float, Floats]:
    """Soft-DTW, and its gradient (n, components) with respect to ``x``; see :func:`value`."""

@final
class SearchIndex:
    def __new__(cls, candidates: Sequence[ArrayLike], gamma: float = 1.0) -> SearchIndex: ...
    def __len__(self) -> int: ...
    def nearest(self, queries: Sequence[ArrayLike], n: int) -> tuple[Integers, Floats]: ...

@final
class GoalEstimator:
    def __new__(cls, experts: Floats, *, similar: int = 800, goals: int = 20) -> GoalEstimator: ...
    def __len__(self) -> int: ...
    def estimate(self, past: Floats) -> tuple[Floats, Floats]: ...

@final
class Flow:
    def __new__(cls, goal: tuple[float, float], metrics: Floats) -> Flow: ...
    def velocity(self, position: Floats, step: int) -> Floats: ...
    def rollout(self, start: Floats, dt: float, steps: int) -> Floats: ...
    def certificate(self, path: Floats, dt: float) -> dict[str, Any]: ...

def baseline(name: str, past: Floats, asked: int, seed: int, goals: Floats | None) -> dict[str, Any]: ...
def displacement_errors(paths: Floats, truth: Floats) -> tuple[Floats, Floats]: ...
def kde_nll(paths: Floats, truth: Floats, weights: Floats | None) -> Floats: ...
def mahalanobis(paths: Floats, truth: Floats, weights: Floats | None) -> tuple[Floats, Floats]: ...
def spread_between(paths: Floats) -> tuple[Floats, Floats]: ...
def collisions(paths: Floats, radius: float) -> tuple[Flags, Floats]: ...
def scores(
    paths: Sequence[Floats],
    truth: Sequence[Floats],
    past: Sequence[Floats],
    weights: Sequence[Floats | None],
    goals: Sequence[Floats | None],
) -> str: ...
def conventions() -> list[tuple[str, list[str]]]: ...
def windows(
    convention: str, folder: _Path | None, fold: str, part: str, rule: str | None, recording: Recording | None
) -> list[dict[str, Any]]: ...

@final
class TestSet:
    def __new__(cls, convention: str, folder: _Path | None, fold: str, rule: str | None) -> TestSet: ...
    def __len__(self) -> int: ...
    def recordings(self) -> list[Recording]: ...
    def observed(self, index: int) -> dict[str, Any]: ...
    @staticmethod
    def check(
        protocol: str, name: str, pedestrians: int, paths: Floats, weights: Floats | None, goals: Floats | None
    ) -> None: ...
    def score(
        self, protocol: str, name: str, forecasts: Sequence[tuple[Floats, Floats | None, Floats | None]]
    ) -> str: ...

def evaluate_model(
    model: Model, folder: _Path | None, protocols: list[str], progress: Callable[[int, int], Any] | None
) -> list[str]: ...
def report(title: str, rows: list[str]) -> str: ...
