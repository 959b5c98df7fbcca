"""The benchmark: windows of the five scenes of ETH/UCY, and models of one's own measured on them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, floats
from ddl_forecast._forecast import Forecast
from ddl_forecast._forecaster import Forecaster
from ddl_forecast._recording import Recording

Folder = Union[str, "os.PathLike[str]", None]
#: Hypotheses (n, k, 12, 2) or one path (n, 12, 2), metres; or those with weights (n, k).
Prediction = Union[Floats, "tuple[Floats, Floats]", Forecast]
#: What is measured: called with (n, 8, 2), under ``online`` also with the rows seen before.
Predictor = Callable[..., Prediction]
#: Called with what is done and what there is to do.
Progress = Callable[[int, int], Any]


@dataclass(frozen=True, eq=False)
class Window:
    """20 steps of 0.4 s, with the pedestrians who are there at each of them."""

    #: (n, 8, 2) metres.
    past: Floats
    #: (n, 12, 2) metres.
    future: Floats
    #: Who they are: whole numbers or words.
    ids: NDArray[Any]
    #: Last observed frame.
    frame: int
    #: Frame numbers in 0.4 s.
    frame_step: int
    #: Name of the recording.
    recording: str


def windows(
    source: Recording | str = "star",
    *,
    fold: str = "eth",
    part: str = "test",
    rule: str | None = None,
    data: Folder = None,
) -> list[Window]:
    """Windows of a recording, or of a fold of the benchmark.

    Parameters
    ----------
    source
        A recording (every complete window), or a data convention: ``"star"``, ``"social-gan"``, ``"simulated"``.
    fold, part
        Of a convention: the scene left out (``eth``, ``hotel``, ``univ``, ``zara1``, ``zara2``), ``"test"`` windows or ``"training"``.
    rule
        Which stretches count: ``published``, ``complete``, ``social-gan``; otherwise that of the convention's tables.
    data
        Folder of the convention's files; otherwise the environment variable DDL_DATASETS.
    """
    if isinstance(source, Recording):
        parts = _core.windows("simulated", None, "", part, rule or "complete", source._core)
    else:
        parts = _core.windows(source, data, fold, part, rule, None)
    return [Window(**{**one, "ids": np.array(one["ids"])}) for one in parts]


class Results:
    """Results, a row a fold, protocol and model, with the conditions of each number."""

    def __init__(self, rows: Iterable[str]) -> None:
        self._rows = list(rows)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Conditions and scores of each row, named as in ``report.json``."""
        return [json.loads(row) for row in self._rows]

    def to_markdown(self, title: str = "Results") -> str:
        """Tables, one for each convention, window rule and protocol, with means over the folds."""
        return _core.report(title, self._rows)

    def mean(self, score: str = "min_ade", *, protocol: str = "fair") -> float:
        """Mean over folds of a score of the model's own rows under a protocol.

        Raises
        ------
        ValueError
            There is no such row.
        """
        values: dict[str, float] = {}
        for row in self.rows:
            conditions = row["conditions"]
            if conditions["protocol"] == protocol:
                values.setdefault(conditions["fold"], row["scores"][score])
        if not values:
            raise ValueError(f"there is no row of the protocol {protocol!r}")
        return float(np.mean(list(values.values())))

    def __add__(self, other: Results) -> Results:
        return Results([*self._rows, *other._rows])

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"Results({len(self)} rows)"


def evaluate(
    model: Predictor | Forecaster | Mapping[str, Predictor | Forecaster],
    *,
    folds: Sequence[str] | None = None,
    protocols: Sequence[str] = ("fair",),
    convention: str = "star",
    rule: str | None = None,
    name: str = "my model",
    data: Folder = None,
    progress: Progress | bool | None = None,
) -> Results:
    """Measure a model on the folds of the benchmark, as every other number of this project was measured.

    A function is called with the (n, 8, 2) observed positions of each test window, metres, and never with its future. It returns
    hypotheses (n, k, 12, 2), at most 20, or one path (n, 12, 2), or hypotheses with weights (n, k), or a :class:`Forecast`.

    Parameters
    ----------
    model
        A function for all folds; or a mapping from fold to function, as for a model trained on each. A :class:`Forecaster` is measured on
        the fold that it was trained without.
    folds
        Otherwise all of the convention, or those of the mapping.
    protocols
        ``fair``: at most 20 hypotheses, the best is scored. ``single``: one forecast; of several hypotheses the one of least expected
        ADE. ``online``, ``online-single``: the function gets a second argument, a mapping of the columns frame, id, x and y of what was
        seen in the same recording until then.
    convention, rule, data
        As for :func:`windows`.
    name
        What the model is called in the tables.
    progress
        Called with windows (of a Forecaster: pedestrians) done and in all; True shows a bar where tqdm is installed.

    Raises
    ------
    FileNotFoundError
        The recordings are not there.
    ValueError
        A fold, a protocol or what the function returned is wrong.

    Examples
    --------
    >>> from ddl_forecast import baselines, evaluate
    >>> results = evaluate(baselines.constant_velocity, convention="simulated", folds=["plaza"], name="constant velocity")
    >>> round(results.mean("min_ade"), 3) > 0
    True
    """
    if isinstance(model, Forecaster):
        return _of_forecaster(model, protocols, data, progress)
    known = dict(_core.conventions())
    if convention not in known:
        raise ValueError(f"convention must be one of {', '.join(known)}; found {convention!r}")
    asked = folds if folds is not None else [*model] if isinstance(model, Mapping) else known[convention]
    rows = Results([])
    for fold in asked:
        of_fold = model[fold] if isinstance(model, Mapping) else model
        if isinstance(of_fold, Forecaster):
            rows += _of_forecaster(of_fold, protocols, data, progress)
            continue
        tests = _core.TestSet(convention, data, fold, rule)
        for protocol in protocols:
            rows += Results([_measured(tests, of_fold, protocol, name, f"{fold}, {protocol}", progress)])
    return rows


def _of_forecaster(model: Forecaster, protocols: Sequence[str], data: Folder, progress: Progress | bool | None) -> Results:
    with _Told(progress, "pedestrians") as told:
        return Results(_core.evaluate_model(model._core, data, list(protocols), told.update))


def _measured(
    tests: _core.TestSet, model: Predictor, protocol: str, name: str, title: str, progress: Progress | bool | None
) -> str:
    watching = protocol.startswith("online")
    seen = {one.name: _Seen(Recording._of(one)) for one in tests.recordings()} if watching else {}
    made = []
    with _Told(progress, title) as told:
        for index in range(len(tests)):
            window = tests.observed(index)
            earlier = (seen[window["recording"]].until(window["frame"]),) if watching else ()
            made.append(_prediction(model(window["past"], *earlier), index, title))
            told.update(index + 1, len(tests))
    return tests.score(protocol, name, made)


def _prediction(made: Prediction, index: int, title: str) -> tuple[Floats, Floats | None, Floats | None]:
    if isinstance(made, Forecast):
        if not made.valid.all():
            raise ValueError(f"window {index} of {title}: some pedestrians were not forecast")
        return made.paths, made.weights, made.goals
    paths, weights = made if isinstance(made, tuple) else (made, None)
    array = np.asarray(paths, dtype=np.float64)
    if array.ndim == 3:
        array = array[:, None]
    given = None if weights is None else floats(weights, 2, "weights", "(n, k)")
    return floats(array, 4, "paths", "(n, k, 12, 2)"), given, None


class _Seen:
    """What was seen in a recording until a frame: slices of its columns, which are in order of frames."""

    def __init__(self, recording: Recording) -> None:
        self._columns = {"frame": recording.frame, "id": recording.id, "x": recording.x, "y": recording.y}

    def until(self, frame: int) -> dict[str, NDArray[Any]]:
        rows = int(np.searchsorted(self._columns["frame"], frame, side="right"))
        return {name: values[:rows].copy() for name, values in self._columns.items()}


class _Told:
    """Progress to a function, to a bar of tqdm, or to nobody."""

    def __init__(self, progress: Progress | bool | None, title: str) -> None:
        self._call = progress if callable(progress) else None
        self._bar: Any = None
        if progress is True:
            try:
                from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
            except ImportError:
                return
            self._bar = tqdm(desc=title)

    def update(self, done: int, total: int) -> None:
        if self._call is not None:
            self._call(done, total)
        if self._bar is not None:
            self._bar.total = total
            self._bar.update(done - self._bar.n)

    def __enter__(self) -> _Told:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
