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
    """A trained model, which forecasts the next 4.8 s from the last 3.2 s.

    It may be used by several threads at once, and pickled: the name or path of the model is, so a path must be there where it is
    unpickled.

    Parameters
    ----------
    model
        A built-in model: ``"hotel"`` (for new places), ``"eth"``, ``"univ"``, ``"zara1"`` or ``"zara2"``, each named by the scene of
        ETH/UCY that it was trained without. Or a path: the folder of a training, or a packed model (``./hotel`` for a folder of that
        name).
    keep_clear
        Distance in metres, such as 0.4, that pedestrians keep from where the others most likely go; None to walk as if alone.

    Raises
    ------
    FileNotFoundError
        There is no such model.
    ValueError
        What lies there is damaged, or of another version.

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
            raise FileNotFoundError(f"there is no model {name!r}: give a path, or the name of a built-in model ({', '.join(names)})")
        # A folder of that name does not stand in the way of a built-in model.
        self._name = name if name in names else os.path.abspath(name)
        self._keep_clear = keep_clear
        self._core = _core.Model.open(self._name, keep_clear)

    @property
    def hypotheses(self) -> int:
        """Hypotheses a pedestrian, k."""
        return self._core.hypotheses

    @property
    def parameter_count(self) -> int:
        """Numbers learned by its networks."""
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
            (n, 8, 2) positions, metres, 0.4 s apart, the last one now; NaN where a pedestrian was not seen. Holes of up to 2
            positions are filled on a straight line; what was seen before a longer hole does not count. Who was then seen at 2
            positions or more, and now, is forecast; the rest is padded at the mean velocity.
        neighbours
            (m, 8, 2) of others who are there, whom the forecast takes into account and does not contain.
        samples
            20 hypotheses, or 1: the one forecast of the model, made to be right on average.
        whole
            Forecast only who was seen at all 8 positions.
        certificates
            Keep the evidence, step by step, that each hypothesis comes nearer to its goal.

        Raises
        ------
        ValueError
            A wrong shape, an infinite number, or NaN in one of two coordinates; the message names row and step.

        Warns
        -----
        DoubtWarning
            A motion is unlike those of the training: pixels instead of metres, another time step, or no pedestrian.

        Examples
        --------
        >>> import numpy as np
        >>> past = np.stack([np.linspace([0, 0], [3.5, 0], 8), np.linspace([6, 1], [2.5, 1], 8)])
        >>> past[1, :3] = np.nan  # the second one came later
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
        """Forecast many scenes, each as :meth:`forecast` does, on all threads."""
        others: list[ArrayLike | None] = [None] * len(pasts) if neighbours is None else list(neighbours)
        if len(others) != len(pasts):
            raise ValueError(f"{len(pasts)} scenes but neighbours of {len(others)}")
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
        """Forecast from every frame of a recording that has anybody to forecast, or with ``last`` from the last such frame only."""
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
        """Columns in, columns out: forecasts of columns of lists, numpy, pandas or polars.

        The columns are those of :meth:`Forecast.to_dict`; ``pandas.DataFrame(...)`` or ``polars.DataFrame(...)`` makes a table of them.

        Raises
        ------
        ValueError
            A value is wrong (row and column are named), or nobody was seen long enough to be forecast.
        """
        recording = Recording(frame, id, x, y, fps=fps)
        made = self.forecast_recording(recording, last=last, samples=samples, whole=whole)
        if not made:
            raise ValueError("nobody was seen at two steps of 0.4 s in a row; give fps, the frame numbers in a second")
        return table(made)

    def goals(self, past: ArrayLike, *, neighbours: ArrayLike | None = None) -> tuple[Floats, Floats]:
        """Where the pedestrians may be going: (n, 20, 2) positions in 4.8 s, metres, and (n, 20) weights."""
        array, asked = scene(past, neighbours)
        return self._core.goals(array, asked)

    def show(self, recording: Recording, path: str | os.PathLike[str] | None = None, *, moments: int = 60) -> Page:
        """The forecasts of a recording as a page with a player: what was observed, where each may go, and what then happened.

        The page needs no network. Without ``path`` it is written to a temporary folder; in a notebook it is shown there, and
        ``Page.open()`` opens it in a browser.
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
    """Warns where speeds are not those of pedestrians: wrong units or a wrong rate give forecasts that look right and mean nothing."""
    if not isinstance(recording, Recording):
        raise TypeError(f"recording must be a Recording, as read('tracks.csv') gives it; found {type(recording).__name__}")
    doubt = recording.doubt()
    if doubt is not None:
        warnings.warn(f"{recording.name}: {doubt}", DoubtWarning, stacklevel=3)


def _told(forecasts: list[Forecast]) -> list[Forecast]:
    """The forecasts, with a warning of the first that has unfamiliar motions."""
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
    """A page that was written."""

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
