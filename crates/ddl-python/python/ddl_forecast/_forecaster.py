"""A trained model."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, plan_rows, scene
from ddl_forecast._forecast import DoubtWarning, Forecast, table
from ddl_forecast._recording import Recording


class Forecaster:
    """A trained model that forecasts the next 4.8 s from the last 3.2 s.

    It may be used by several threads at once, and pickled. A pickle holds the name or path of the model, so a path must
    exist where it is unpickled.

    Parameters
    ----------
    model
        A built-in model: ``"world"``, or ``"eth"``, ``"hotel"``, ``"univ"``, ``"zara1"`` or ``"zara2"``, each named
        after the ETH/UCY scene that it was trained without. Or a path: the folder of a training run, or a packed model
        (``./world`` for a folder with the name of a built-in model).

    Raises
    ------
    FileNotFoundError
        The model is missing.
    ValueError
        The file is damaged, or of another version.

    Examples
    --------
    >>> forecaster = Forecaster("eth")
    >>> forecaster
    Forecaster('eth')
    >>> forecaster.hypotheses
    20
    """

    def __init__(self, model: str | os.PathLike[str] = "world") -> None:
        name = os.fspath(model)
        names = _core.Model.builtin_names()
        if name not in names and not os.path.exists(name):
            builtin = f"a built-in model ({', '.join(names)})"
            raise FileNotFoundError(f"there is no model {name!r}: give a path, or the name of {builtin}")
        # A built-in model takes precedence over a folder of that name.
        self._name = name if name in names else os.path.abspath(name)
        self._core = _core.Model.open(self._name)

    @property
    def hypotheses(self) -> int:
        """Number of hypotheses for each pedestrian, k."""
        return self._core.hypotheses

    @property
    def parameter_count(self) -> int:
        """Number of learned parameters of its networks."""
        return self._core.parameter_count

    def forecast(
        self,
        past: ArrayLike,
        *,
        neighbours: ArrayLike | None = None,
        samples: int = 20,
        whole: bool = False,
        certificates: bool = False,
        joint: bool = False,
        plan: ArrayLike | None = None,
        ego: int | None = None,
    ) -> Forecast:
        """Forecast one scene.

        Parameters
        ----------
        past
            (n, 8, 2) positions, metres, 0.4 s apart, the last one now; NaN where a pedestrian was not observed. Such
            positions are estimated from the others; those before a gap of more than 2 s are ignored. A pedestrian is
            forecast if the last position and at least one other remain.
        neighbours
            (m, 8, 2) positions of other pedestrians, which influence the forecast but are not forecast.
        samples
            20: all hypotheses; 1: the central forecast of the model, with the least expected error.
        whole
            Forecast only pedestrians tracked for all 8 steps: those with a position at the first.
        certificates
            Return the evidence that each hypothesis approaches its goal, for each step.
        joint
            Joint futures of the scene instead of hypotheses of each pedestrian: hypothesis k of all is one future, in
            which people who walk together stay together, and seldom anybody walks through another.
        plan
            With ``joint``: (m, 3) rows of t in seconds from now, x and y, the plan of a robot, to which the pedestrians
            respond.
        ego
            Row of ``past`` that follows the plan; None: none of them.

        Raises
        ------
        ValueError
            A wrong shape, an infinite number, or NaN in one of two coordinates; the message names row and step.

        Warns
        -----
        DoubtWarning
            A motion is unlike the training motions, or a position is where the pedestrian cannot be: pixels instead of
            metres, another time step, or no pedestrian.

        Examples
        --------
        >>> import numpy as np
        >>> past = np.stack([np.linspace([0, 0], [3.5, 0], 8), np.linspace([6, 1], [2.5, 1], 8)])
        >>> past[1, :3] = np.nan  # the second one appeared later
        >>> forecast = Forecaster().forecast(past)
        >>> forecast.paths.shape, forecast.unseen.tolist()
        ((2, 20, 12, 2), [0, 3])
        """
        return self.forecast_all(
            [past],
            neighbours=None if neighbours is None else [neighbours],
            samples=samples,
            whole=whole,
            certificates=certificates,
            joint=joint,
            plan=plan,
            ego=ego,
        )[0]

    def forecast_all(
        self,
        pasts: Sequence[ArrayLike],
        *,
        neighbours: Sequence[ArrayLike | None] | None = None,
        samples: int = 20,
        whole: bool = False,
        certificates: bool = False,
        joint: bool = False,
        plan: ArrayLike | None = None,
        ego: int | None = None,
    ) -> list[Forecast]:
        """Forecast many scenes on all threads, each as in :meth:`forecast`."""
        others: list[ArrayLike | None] = [None] * len(pasts) if neighbours is None else list(neighbours)
        if len(others) != len(pasts):
            raise ValueError(f"neighbours are of {len(others)} scenes, pasts of {len(pasts)}")
        scenes = [scene(past, other) for past, other in zip(pasts, others, strict=True)]
        arrays, asked = [array for array, _ in scenes], [count for _, count in scenes]
        if plan is not None and (not joint or certificates):
            raise ValueError("a plan needs joint=True, and has no certificates")
        if plan is None and ego is not None:
            raise ValueError("ego is the row that follows a plan: give plan")
        for past in pasts:
            rows = np.asarray(past)
            if ego is not None and not (0 <= ego < len(rows) and np.isfinite(rows[ego, -1]).all()):
                raise ValueError(f"ego is row {ego}, which past does not have or does not observe now")
        given = None if plan is None else (plan_rows(plan), ego)
        made, doubts = self._core.forecast(arrays, asked, samples, whole, certificates, joint, given)
        forecasts = []
        for parts, array, count in zip(made, arrays, asked, strict=True):
            missing = np.isnan(parts["weights"][:, 0]) if parts["weights"].size else np.ones(count, dtype=np.bool_)
            left_out = int((missing & np.isfinite(array[:count, -1]).all(axis=1)).sum()) if joint else 0
            forecasts.append(Forecast._of(parts, joint=joint, left_out=left_out))
        return _told(forecasts, doubts)

    def forecast_recording(
        self,
        recording: Recording,
        *,
        last: bool = False,
        samples: int = 20,
        whole: bool = False,
        max_age: float | None = None,
        every: float | None = None,
        certificates: bool = False,
        joint: bool = False,
    ) -> list[Forecast]:
        """Forecast from every moment of a recording with pedestrians to forecast, in order of time.

        Each forecast uses the rows up to its moment, and no later ones.

        Parameters
        ----------
        recording
            From :func:`read`, or of columns.
        last
            Only the last moment.
        whole
            Forecast only pedestrians tracked for all 8 steps.
        max_age
            Seconds until which a pedestrian is carried on after its last row; 0: only those with a row at the moment.
            Default: 0.4, or the time between its last rows if that is longer.
        every
            Least time between two moments, seconds. Default: 0 (every frame), or 0.4 where each pedestrian has a clock
            of its own.
        samples, certificates, joint
            As for :meth:`forecast`.

        Warns
        -----
        DoubtWarning
            The rate or the units look wrong, or positions are left out because the pedestrians cannot be there.
        """
        _tell_doubt(recording)
        made, doubt = self._core.forecast_recording(
            recording._core, last, samples, whole, max_age, every, certificates, joint
        )
        return _told(
            [Forecast._of(parts, joint=joint) for parts in made], [f"{recording.name}: {doubt}"] if doubt else []
        )

    def forecast_table(
        self,
        frame: ArrayLike | None = None,
        id: ArrayLike = (),
        x: ArrayLike = (),
        y: ArrayLike = (),
        *,
        time: ArrayLike | None = None,
        fps: float | None = None,
        last: bool = False,
        samples: int = 20,
        whole: bool = False,
        max_age: float | None = None,
        every: float | None = None,
    ) -> dict[str, NDArray[Any]]:
        """Forecast from columns of lists, numpy, pandas or polars, and return columns.

        Columns and options are those of :class:`Recording` and :meth:`forecast_recording`.
        The result has the columns of :meth:`Forecast.to_dict`; ``pandas.DataFrame(...)`` or ``polars.DataFrame(...)``
        makes a table of them.

        Raises
        ------
        ValueError
            A value is wrong (the message names row and column), or no pedestrian was observed long enough.
        """
        recording = Recording(frame, id, x, y, time=time, fps=fps)
        made = self.forecast_recording(recording, last=last, samples=samples, whole=whole, max_age=max_age, every=every)
        if not made:
            missing = "no pedestrian was tracked for all 8 steps"
            raise ValueError(f"{missing}; set fps to the frame numbers per second")
        return table(made)

    def goals(self, past: ArrayLike, *, neighbours: ArrayLike | None = None) -> tuple[Floats, Floats]:
        """Estimate goals: (n, 20, 2) positions in 4.8 s, metres, and (n, 20) weights."""
        array, asked = scene(past, neighbours)
        return self._core.goals(array, asked)

    def was_trained_on(self, recording: Recording) -> bool:
        """Whether the model was trained on these tracks, under whatever name: then its errors on them are no test."""
        return self._core.was_trained_on(recording._core)

    def show(
        self,
        recording: Recording,
        path: str | os.PathLike[str] | None = None,
        *,
        moments: int = 60,
        joint: bool = False,
    ) -> Page:
        """Write a page that plays the forecasts of a recording: observations, hypotheses and true paths.

        With ``joint`` it steps through joint futures: hypothesis ``k`` of all pedestrians is future ``k``.

        The page is self-contained. Without ``path`` it is written to a temporary folder. In a notebook it is shown in
        place, and ``Page.open()`` opens it in a browser.
        """
        _tell_doubt(recording)
        html, doubt = self._core.page(recording._core, moments, joint)
        if doubt is not None:
            warnings.warn(f"{recording.name}: {doubt}", DoubtWarning, stacklevel=2)
        if path is None:
            import tempfile

            path = Path(tempfile.mkdtemp(prefix="ddl-")) / f"{recording.name}.html"
        written = Path(path)
        written.write_text(html, encoding="utf-8")
        return Page(written)

    def __repr__(self) -> str:
        return f"Forecaster({self._name!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        return Forecaster, (self._name,)


def _tell_doubt(recording: Recording) -> None:
    """Warn of suspicious speeds: wrong units or a wrong rate give forecasts that are plausible but meaningless."""
    if not isinstance(recording, Recording):
        raise TypeError(
            f"recording must be a Recording, as read('tracks.csv') gives it; found {type(recording).__name__}"
        )
    doubt = recording.doubt()
    if doubt is not None:
        warnings.warn(f"{recording.name}: {doubt}", DoubtWarning, stacklevel=3)


def _told(forecasts: list[Forecast], doubts: list[str]) -> list[Forecast]:
    """The forecasts, with warnings about doubts and about the first one with unfamiliar motions."""
    for doubt in doubts:
        warnings.warn(doubt, DoubtWarning, stacklevel=4)
    for forecast in forecasts:
        words = forecast.unfamiliar()
        if words is not None:
            frame = "" if forecast.frame is None else f", first at frame {forecast.frame}"
            warnings.warn(words + frame, DoubtWarning, stacklevel=4)
            break
    return forecasts


class Page:
    """A written page."""

    def __init__(self, path: Path) -> None:
        #: The file.
        self.path = path

    def open(self) -> None:
        """Open it in the browser."""
        import webbrowser

        webbrowser.open(self.path.absolute().as_uri())

    def _repr_html_(self) -> str:
        from html import escape

        page = escape(self.path.read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{page}" width="100%" height="640" style="border:0"></iframe>'

    def __repr__(self) -> str:
        return f"Page({str(self.path)!r})"
