"""A trained model."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike, NDArray

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, scene
from ddl_forecast._forecast import DoubtWarning, Forecast, table
from ddl_forecast._recording import Recording


class Forecaster:
    """A trained model that forecasts the next 4.8 s from the last 3.2 s.

    It may be used by several threads at once, and pickled. A pickle holds the name or path of the model, so a path must
    exist where it is unpickled.

    Parameters
    ----------
    model
        A built-in model: ``"hotel"`` (for new places), ``"eth"``, ``"univ"``, ``"zara1"`` or ``"zara2"``, each named
        after the ETH/UCY scene that it was trained without. Or a path: the folder of a training run, or a packed model
        (``./hotel`` for a folder with the name of a built-in model).
    keep_clear
        Distance in metres, such as 0.4, that pedestrians keep from each other's most likely paths, or None.

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

    def __init__(self, model: str | os.PathLike[str] = "hotel", *, keep_clear: float | None = None) -> None:
        name = os.fspath(model)
        names = _core.Model.builtin_names()
        if name not in names and not os.path.exists(name):
            builtin = f"a built-in model ({', '.join(names)})"
            raise FileNotFoundError(f"there is no model {name!r}: give a path, or the name of {builtin}")
        # A built-in model takes precedence over a folder of that name.
        self._name = name if name in names else os.path.abspath(name)
        self._keep_clear = keep_clear
        self._core = _core.Model.open(self._name, keep_clear)

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
    ) -> Forecast:
        """Forecast one scene.

        Parameters
        ----------
        past
            (n, 8, 2) positions, metres, 0.4 s apart, the last one now; NaN where a pedestrian was not observed. Gaps
            of up to 2 positions are filled on a straight line; positions before a longer gap are ignored. A
            pedestrian is forecast if the last position and at least one other remain; earlier positions are padded at
            the mean velocity.
        neighbours
            (m, 8, 2) positions of other pedestrians, which influence the forecast but are not forecast.
        samples
            20: all hypotheses; 1: the central forecast of the model, with the least expected error.
        whole
            Forecast only pedestrians observed at all 8 positions.
        certificates
            Return the evidence that each hypothesis approaches its goal, for each step.

        Raises
        ------
        ValueError
            A wrong shape, an infinite number, or NaN in one of two coordinates; the message names row and step.

        Warns
        -----
        DoubtWarning
            A motion is unlike the training motions: pixels instead of metres, another time step, or no pedestrian.

        Examples
        --------
        >>> import numpy as np
        >>> past = np.stack([np.linspace([0, 0], [3.5, 0], 8), np.linspace([6, 1], [2.5, 1], 8)])
        >>> past[1, :3] = np.nan  # the second one appeared later
        >>> forecast = Forecaster().forecast(past)
        >>> forecast.paths.shape, forecast.made_up.tolist()
        ((2, 20, 12, 2), [[0, 0], [3, 0]])
        """
        return self.forecast_all(
            [past],
            neighbours=None if neighbours is None else [neighbours],
            samples=samples,
            whole=whole,
            certificates=certificates,
        )[0]

    def forecast_all(
        self,
        pasts: Sequence[ArrayLike],
        *,
        neighbours: Sequence[ArrayLike | None] | None = None,
        samples: int = 20,
        whole: bool = False,
        certificates: bool = False,
    ) -> list[Forecast]:
        """Forecast many scenes on all threads, each as in :meth:`forecast`."""
        others: list[ArrayLike | None] = [None] * len(pasts) if neighbours is None else list(neighbours)
        if len(others) != len(pasts):
            raise ValueError(f"neighbours are of {len(others)} scenes, pasts of {len(pasts)}")
        scenes = [scene(past, other) for past, other in zip(pasts, others, strict=True)]
        arrays, asked = [array for array, _ in scenes], [count for _, count in scenes]
        made = self._core.forecast(arrays, asked, samples, whole, certificates)
        return _told([Forecast._of(parts) for parts in made])

    def forecast_recording(
        self,
        recording: Recording,
        *,
        last: bool = False,
        samples: int = 20,
        whole: bool = False,
        certificates: bool = False,
    ) -> list[Forecast]:
        """Forecast from every frame of a recording with pedestrians to forecast; with ``last`` from the last one."""
        _tell_doubt(recording)
        made = self._core.forecast_recording(recording._core, last, samples, whole, certificates)
        return _told([Forecast._of(parts) for parts in made])

    def forecast_table(
        self,
        frame: ArrayLike,
        id: ArrayLike,
        x: ArrayLike,
        y: ArrayLike,
        *,
        fps: float | None = None,
        last: bool = False,
        samples: int = 20,
        whole: bool = False,
    ) -> dict[str, NDArray[Any]]:
        """Forecast from columns of lists, numpy, pandas or polars, and return columns.

        The result has the columns of :meth:`Forecast.to_dict`; ``pandas.DataFrame(...)`` or ``polars.DataFrame(...)``
        makes a table of them.

        Raises
        ------
        ValueError
            A value is wrong (the message names row and column), or no pedestrian was observed long enough.
        """
        recording = Recording(frame, id, x, y, fps=fps)
        made = self.forecast_recording(recording, last=last, samples=samples, whole=whole)
        if not made:
            missing = "no pedestrian was observed at 2 consecutive time steps of 0.4 s"
            raise ValueError(f"{missing}; set fps to the frame numbers per second")
        return table(made)

    def goals(self, past: ArrayLike, *, neighbours: ArrayLike | None = None) -> tuple[Floats, Floats]:
        """Estimate goals: (n, 20, 2) positions in 4.8 s, metres, and (n, 20) weights."""
        array, asked = scene(past, neighbours)
        return self._core.goals(array, asked)

    def show(self, recording: Recording, path: str | os.PathLike[str] | None = None, *, moments: int = 60) -> Page:
        """Write a page that plays the forecasts of a recording: observations, hypotheses and true paths.

        The page is self-contained. Without ``path`` it is written to a temporary folder. In a notebook it is shown in
        place, and ``Page.open()`` opens it in a browser.
        """
        _tell_doubt(recording)
        html = self._core.page(recording._core, moments)
        if path is None:
            import tempfile

            path = Path(tempfile.mkdtemp(prefix="ddl-")) / f"{recording.name}.html"
        written = Path(path)
        written.write_text(html, encoding="utf-8")
        return Page(written)

    def __repr__(self) -> str:
        clear = "" if self._keep_clear is None else f", keep_clear={self._keep_clear}"
        return f"Forecaster({self._name!r}{clear})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (self._name, self._keep_clear)


def _tell_doubt(recording: Recording) -> None:
    """Warn of suspicious speeds: wrong units or a wrong rate give forecasts that are plausible but meaningless."""
    if not isinstance(recording, Recording):
        raise TypeError(
            f"recording must be a Recording, as read('tracks.csv') gives it; found {type(recording).__name__}"
        )
    doubt = recording.doubt()
    if doubt is not None:
        warnings.warn(f"{recording.name}: {doubt}", DoubtWarning, stacklevel=3)


def _told(forecasts: list[Forecast]) -> list[Forecast]:
    """The forecasts, with a warning about the first one with unfamiliar motions."""
    for forecast in forecasts:
        words = forecast.unfamiliar()
        if words is not None:
            frame = "" if forecast.frame is None else f", first at frame {forecast.frame}"
            warnings.warn(words + frame, DoubtWarning, stacklevel=4)
            break
    return forecasts


def _rebuilt(name: str, keep_clear: float | None) -> Forecaster:
    return Forecaster(name, keep_clear=keep_clear)


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
