"""The benchmark: windows of the five scenes of ETH/UCY, and the evaluation of custom models on them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, floats, unmasked
from ddl_forecast._forecast import Forecast
from ddl_forecast._forecaster import Forecaster
from ddl_forecast._recording import Recording

Folder = Union[str, "os.PathLike[str]", None]
#: Hypotheses (n, k, 12, 2) or one path (n, 12, 2), metres; or those with weights (n, k).
Prediction = Union[Floats, "tuple[Floats, Floats]", Forecast]
#: A model: called with (n, 8, 2), under ``online`` also with the earlier rows.
Predictor = Callable[..., Prediction]
#: Called with the numbers done and in total.
Progress = Callable[[int, int], Any]


@dataclass(frozen=True, eq=False)
class Window:
    """20 time steps of 0.4 s, with the pedestrians present at all of them.

    Attributes
    ----------
    past : (n, 8, 2)
        Metres.
    future : (n, 12, 2)
        Metres.
    ids : (n,)
        Ids of the pedestrians: whole numbers or words.
    frame, frame_step
        Last observed frame or time, and frame numbers (or time) in 0.4 s.
    recording : str
        Name of the recording.
    """

    past: Floats
    future: Floats
    ids: NDArray[Any]
    frame: Any
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
        A recording, or a data convention: ``"star"``, ``"social-gan"``, ``"simulated"``.
    fold, part
        For a convention: the scene left out (``eth``, ``hotel``, ``univ``, ``zara1``, ``zara2``), and the windows
        ``"test"`` or ``"training"``.
    rule
        Window rule: ``published``, ``complete``, ``social-gan``, ``observed``; default: that of the convention's
        tables, for a recording ``observed``: what a live stream would have observed at each moment, on any clock.
    data
        Folder of the convention's files; default: the environment variable DDL_DATASETS.
    """
    if isinstance(source, Recording):
        parts = _core.windows("simulated", None, "", part, rule or "observed", source._core)
    else:
        parts = _core.windows(source, data, fold, part, rule, None)
    return [Window(**{**one, "ids": np.array(one["ids"])}) for one in parts]


class Results:
    """Results: one row for each fold, protocol and model, with the conditions of each number."""

    def __init__(self, rows: Iterable[str]) -> None:
        self._rows = list(rows)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Conditions and scores of each row, named as in ``report.json``."""
        return [json.loads(row) for row in self._rows]

    def to_markdown(self, title: str = "Results") -> str:
        """Tables, one for each convention, window rule and protocol, with means over the folds."""
        return _core.report(title, self._rows)

    def mean(
        self, score: str = "min_ade", *, protocol: str = "fair", name: str | None = None, rule: str | None = None
    ) -> float:
        """Mean over folds of a score of one model under a protocol.

        ``name`` and ``rule`` (as in ``conditions["window_rule"]``) select one of several models and window rules.

        Raises
        ------
        ValueError
            The row or its score is missing, a fold has several rows, or rows of several models or conditions match.
        """
        values: dict[str, float] = {}
        kinds = set()
        for row in self.rows:
            conditions = row["conditions"]
            if conditions["protocol"] != protocol:
                continue
            if name not in (None, conditions["forecaster"]) or rule not in (None, _words(conditions["window_rule"])):
                continue
            if conditions["fold"] in values:
                choices = f"choose by name and rule: {self._choices(protocol)}"
                raise ValueError(f"several rows match {conditions['fold']} under {protocol}; {choices}")
            if row["scores"].get(score) is None:
                raise ValueError(f"the rows have no score {score!r}")
            values[conditions["fold"]] = row["scores"][score]
            is_part = conditions.get("test_subset") is not None
            kinds.add((conditions["convention"], _words(conditions["window_rule"]), conditions["forecaster"], is_part))
            if len(kinds) > 1:
                raise ValueError(
                    "rows of several models, conventions, window rules or parts of the test windows match: choose by "
                    f"name and rule: {self._choices(protocol)}"
                )
        if not values:
            raise ValueError(f"no row matches under the protocol {protocol!r}")
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
    """A window rule as one word, with its number if it has one."""
    return (
        rule
        if isinstance(rule, str)
        else "-".join(f"{name}-{number}" for name, of in rule.items() for number in of.values())
    )


PROTOCOLS = ("fair", "single", "online", "online-single", "joint")


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
    """Evaluate a model on the folds of the benchmark, with the metrics of this project.

    A function is called with the (n, 8, 2) observed positions of each test window, metres, but without its future. It
    returns hypotheses (n, k, 12, 2), at most 20, one path (n, 12, 2), hypotheses with weights (n, k), or a
    :class:`Forecast`.

    Parameters
    ----------
    model
        A function for all folds, or a mapping from fold to function for a model trained on each fold. A
        :class:`Forecaster` is evaluated on the fold that it was trained without.
    folds
        Default: all of the convention, or those of the mapping.
    protocols
        ``fair``: at most 20 hypotheses, of which the best counts. ``single``: one path; of several hypotheses the one
        with the least expected ADE. ``online``, ``online-single``: the function gets a second argument, a mapping with
        the columns frame, id, x and y of the recording up to the last observed frame, that of ``past[:, -1]``.
        ``joint``: hypothesis k of all pedestrians is future k of the scene; the best future counts.
    convention, rule, data
        As for :func:`windows`.
    name
        Name of the model in the tables.
    progress
        Called with the numbers of windows (for a Forecaster: pedestrians) done and in total; True shows a tqdm bar.

    Raises
    ------
    FileNotFoundError
        The recordings are missing.
    ValueError
        A fold, a protocol or a result of the function is wrong.

    Examples
    --------
    >>> from ddl_forecast import baselines, evaluate
    >>> results = evaluate(baselines.constant_velocity, convention="simulated", folds=["plaza"], name="cv")
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
            raise ValueError(
                f"{model!r} was trained without {of} {fold} and can only be evaluated on it: set convention={of!r}"
            )
        model = {fold: model}
    asked = list(folds) if folds is not None else [*model] if isinstance(model, Mapping) else known[convention]
    for fold in asked:
        if fold not in known[convention]:
            raise ValueError(f"the convention {convention} has no fold {fold!r}, only {', '.join(known[convention])}")
        if isinstance(model, Mapping) and fold not in model:
            raise ValueError(f"no model for the fold {fold}; the mapping has {', '.join(model)}")
        of_fold = model[fold] if isinstance(model, Mapping) else model
        if isinstance(of_fold, Forecaster) and of_fold._core.trained_on != (convention, fold):
            trained = " ".join(of_fold._core.trained_on)
            seen = f"and was trained on recordings of {convention} {fold}"
            raise ValueError(f"{of_fold!r} was trained without {trained}, {seen}; it cannot be evaluated on them")
    rows = Results([])
    for fold in asked:
        of_fold = model[fold] if isinstance(model, Mapping) else model
        if isinstance(of_fold, Forecaster):
            if rule is not None or name != "my model":
                raise ValueError("a Forecaster has a name and window rules of its own: leave out name and rule")
            rows += _of_forecaster(of_fold, protocols, data, progress)
            continue
        tests = _core.TestSet(convention, data, fold, rule)
        for protocol in protocols:
            rows += Results([_measured(tests, of_fold, protocol, name, f"{fold}, {protocol}", progress)])
    return rows


def _of_forecaster(
    model: Forecaster, protocols: Sequence[str], data: Folder, progress: Progress | bool | None
) -> Results:
    with _Progress(progress, "pedestrians") as told:
        return Results(_core.evaluate_model(model._core, data, list(protocols), told.update))


def _measured(
    tests: _core.TestSet, model: Predictor, protocol: str, name: str, title: str, progress: Progress | bool | None
) -> str:
    watching = protocol.startswith("online")
    seen = {one.name: _Seen(Recording._of(one)) for one in tests.recordings()} if watching else {}
    made = []
    with _Progress(progress, title) as told:
        for index in range(len(tests)):
            window = tests.observed(index)
            earlier = (seen[window["recording"]].until(window["frame"]),) if watching else ()
            count = len(window["past"])
            made.append(
                _prediction(model(window["past"], *earlier), (protocol, name, count), f"window {index} of {title}")
            )
            told.update(index + 1, len(tests))
    return tests.score(protocol, name, made)


def _prediction(
    made: Prediction, asked: tuple[str, str, int], title: str
) -> tuple[Floats, Floats | None, Floats | None]:
    """A copy of the result, so that a model may reuse its arrays."""
    goals: Floats | None = None
    weights: ArrayLike | None
    if isinstance(made, Forecast):
        if not made.valid.all():
            raise ValueError(f"{title}: some pedestrians were not forecast")
        paths, weights, goals = made.paths, made.weights, made.goals
    else:
        paths, weights = made if isinstance(made, tuple) and len(made) == 2 else (made, None)
    try:
        unmasked(paths, "paths")
        array = np.array(paths, dtype=np.float64)
        if array.ndim == 3:
            array = array[:, None]
        array = floats(array, 4, "paths", "(n, k, 12, 2)")
        given = None if weights is None else floats(weights, 2, "weights", "(n, k)").copy()
        _core.TestSet.check(*asked, array, given, goals)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{title}: {error}") from None
    return array, given, None if goals is None else goals.copy()


class _Seen:
    """The rows of a recording up to a frame, as slices of its columns, which are in order of frames."""

    def __init__(self, recording: Recording) -> None:
        self._columns = {"frame": recording.frame, "id": recording.id, "x": recording.x, "y": recording.y}

    def until(self, frame: int) -> dict[str, NDArray[Any]]:
        rows = int(np.searchsorted(self._columns["frame"], frame, side="right"))
        return {name: values[:rows].copy() for name, values in self._columns.items()}


class _Progress:
    """Progress for a function or a tqdm bar, or none."""

    def __init__(self, progress: Progress | bool | None, title: str) -> None:
        self._call = progress if callable(progress) else None
        self._bar: Any = None
        if progress is True:
            try:
                from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
            except ImportError:
                raise ImportError("progress=True shows a bar of tqdm, which is not installed") from None
            self._bar = tqdm(desc=title)

    def update(self, done: int, total: int) -> None:
        if self._call is not None:
            self._call(done, total)
        if self._bar is not None:
            self._bar.total = total
            self._bar.update(done - self._bar.n)

    def __enter__(self) -> _Progress:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
