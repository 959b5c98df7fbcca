"""The benchmark: windows of the five scenes of ETH/UCY, and models of one's own measured on them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
    """20 steps of 0.4 s, with the pedestrians who are there at each of them.

    Attributes
    ----------
    past : (n, 8, 2)
        Metres.
    future : (n, 12, 2)
        Metres.
    ids : (n,)
        Who they are: whole numbers or words.
    frame, frame_step
        Last observed frame, and frame numbers in 0.4 s.
    recording : str
        Name of the recording.
    """

    past: Floats
    future: Floats
    ids: NDArray[Any]
    frame: float
    frame_step: float
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

    def mean(self, score: str = "min_ade", *, protocol: str = "fair", name: str | None = None, rule: str | None = None) -> float:
        """Mean over folds of a score of one model under a protocol.

        ``name`` and ``rule`` (as ``conditions["window_rule"]`` has it) choose among several models and window rules.

        Raises
        ------
        ValueError
            There is no such row, there are several for a fold, or a row has no such score.
        """
        values: dict[str, float] = {}
        for row in self.rows:
            conditions = row["conditions"]
            if conditions["protocol"] != protocol:
                continue
            if name not in (None, conditions["forecaster"]) or rule not in (None, _words(conditions["window_rule"])):
                continue
            if conditions["fold"] in values:
                raise ValueError(f"there are several rows of {conditions['fold']} under {protocol}; choose by name and rule: {self._choices(protocol)}")
            if row["scores"].get(score) is None:
                raise ValueError(f"the rows have no score {score!r}")
            values[conditions["fold"]] = row["scores"][score]
        if not values:
            raise ValueError(f"there is no such row of the protocol {protocol!r}")
        return float(np.mean(list(values.values())))

    def _choices(self, protocol: str) -> list[tuple[str, str]]:
        of_protocol = [row["conditions"] for row in self.rows if row["conditions"]["protocol"] == protocol]
        return sorted({(one["forecaster"], _words(one["window_rule"])) for one in of_protocol})

    def __add__(self, other: Results) -> Results:
        return Results([*self._rows, *other._rows])

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"Results({len(self)} rows)"


def _words(rule: Any) -> str:
    """A window rule in a word, also one with a number."""
    return rule if isinstance(rule, str) else "-".join(f"{name}-{number}" for name, of in rule.items() for number in of.values())


PROTOCOLS = ("fair", "single", "online", "online-single")


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
        seen in the same recording up to the last observed frame, that of ``past[:, -1]``.
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
    if isinstance(protocols, str) or not set(protocols) <= set(PROTOCOLS):
        raise ValueError(f"protocols must be a list of some of {', '.join(PROTOCOLS)}; found {protocols!r}")
    known = dict(_core.conventions())
    if convention not in known:
        raise ValueError(f"convention must be one of {', '.join(known)}; found {convention!r}")
    if isinstance(model, Forecaster):
        of, fold = model._core.trained_on
        if of != convention:
            raise ValueError(f"{model!r} was trained without {of} {fold}; it is measured on that: convention={of!r}")
        model = {fold: model}
    asked = list(folds) if folds is not None else [*model] if isinstance(model, Mapping) else known[convention]
    for fold in asked:
        if fold not in known[convention]:
            raise ValueError(f"there is no fold {fold!r} in the convention {convention}; it has {', '.join(known[convention])}")
        if isinstance(model, Mapping) and fold not in model:
            raise ValueError(f"there is no model for the fold {fold}; there are some for {', '.join(model)}")
        of_fold = model[fold] if isinstance(model, Mapping) else model
        if isinstance(of_fold, Forecaster) and of_fold._core.trained_on != (convention, fold):
            trained = " ".join(of_fold._core.trained_on)
            raise ValueError(f"{of_fold!r} was trained without {trained}, and has seen what it would be measured on as {convention} {fold}")
    rows = Results([])
    for fold in asked:
        of_fold = model[fold] if isinstance(model, Mapping) else model
        if isinstance(of_fold, Forecaster):
            if rule is not None:
                raise ValueError("a Forecaster is measured under the rules of its convention's tables: leave rule out")
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
            count = len(window["past"])
            made.append(_prediction(model(window["past"], *earlier), (protocol, name, count), f"window {index} of {title}"))
            told.update(index + 1, len(tests))
    return tests.score(protocol, name, made)


def _prediction(
    made: Prediction, asked: tuple[str, str, int], title: str
) -> tuple[Floats, Floats | None, Floats | None]:
    """A copy of what was returned, so that a model that uses its arrays again changes nothing that was forecast before."""
    goals: Floats | None = None
    weights: ArrayLike | None
    if isinstance(made, Forecast):
        if not made.valid.all():
            raise ValueError(f"{title}: some pedestrians were not forecast")
        paths, weights, goals = made.paths, made.weights, made.goals
    else:
        paths, weights = made if isinstance(made, tuple) else (made, None)
    array = np.array(paths, dtype=np.float64)
    if array.ndim == 3:
        array = array[:, None]
    try:
        array = floats(array, 4, "paths", "(n, k, 12, 2)")
        given = None if weights is None else floats(weights, 2, "weights", "(n, k)").copy()
        _core.TestSet.check(*asked, array, given, goals)
    except ValueError as error:
        raise ValueError(f"{title}: {error}") from None
    return array, given, None if goals is None else goals.copy()


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
