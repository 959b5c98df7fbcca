"""Recordings of tracks, from files or columns, and back."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, column, numbered, whole

#: Formats of files of tracks, by name.
FORMATS = ("table", "trajnet", "social-gan", "star-csv", "obsmat")


class Recording:
    """Tracks of pedestrians of one place.

    Parameters
    ----------
    frame, id, x, y
        Columns of one length, a row a position: frame number, pedestrian (whole number or word), metres. Any order. Lists, numpy
        arrays, pandas or polars columns.
    fps
        Frame numbers in a second. Where 0.4 s are no whole number of frames, positions are taken on straight lines between frames.
        Without it, the most common difference of two frame numbers is taken to be 0.4 s.
    frame_step
        Frame numbers in 0.4 s, instead of ``fps``.
    name
        What it is called in results.

    Raises
    ------
    ValueError
        A value is missing or not finite (row and column are named), or a pedestrian is twice in a frame.

    Examples
    --------
    >>> recording = Recording([0, 10, 0, 10], [1, 1, 2, 2], [0.0, 0.5, 3.0, 2.5], [0.0, 0.0, 1.0, 1.0], fps=25)
    >>> recording
    Recording('recording', 2 pedestrians, 2 frames, 4 positions)
    """

    def __init__(
        self,
        frame: ArrayLike,
        id: ArrayLike,
        x: ArrayLike,
        y: ArrayLike,
        *,
        fps: float | None = None,
        frame_step: int | None = None,
        name: str = "recording",
    ) -> None:
        ids, words = numbered(id)
        self._core = _core.Recording(
            whole(frame, "frame"), ids, _column(x, "x"), _column(y, "y"), words, fps, frame_step, name
        )

    @classmethod
    def _of(cls, core: _core.Recording) -> Recording:
        recording = cls.__new__(cls)
        recording._core = core
        return recording

    @property
    def name(self) -> str:
        """What it is called."""
        return self._core.name

    @property
    def frame_step(self) -> float:
        """Frame numbers in 0.4 s."""
        return self._core.frame_step

    @property
    def frame(self) -> NDArray[Any]:
        """Frame of each position, ascending; between two frames where positions were taken there."""
        return self._core.columns()[0]

    @property
    def id(self) -> NDArray[Any]:
        """Pedestrian of each position: whole numbers, or words."""
        return np.asarray(self._core.columns()[1])

    @property
    def x(self) -> Floats:
        """Metres."""
        return self._core.columns()[2]

    @property
    def y(self) -> Floats:
        """Metres."""
        return self._core.columns()[3]

    def doubt(self) -> str | None:
        """What looks wrong with the speeds: wrong units or a wrong rate; None where nothing does."""
        return self._core.doubt()

    def write(self, path: str | os.PathLike[str], *, format: str = "table") -> None:
        """Write a file that :func:`read` takes back, position by position, in one of :data:`FORMATS`.

        The file is there whole or not at all. Words as pedestrians can be written as ``table`` and ``trajnet``. No format keeps
        ``fps``: give it to :func:`read` again.
        """
        self._core.write(path, format=format)

    def __len__(self) -> int:
        return len(self._core)

    def __repr__(self) -> str:
        return repr(self._core).replace('"', "'")

    def __reduce__(self) -> tuple[Any, ...]:
        step = self.frame_step
        if step != int(step):
            raise TypeError("a resampled recording cannot be pickled; pickle its columns and rate")
        frame, ids, x, y = self._core.columns()
        return _rebuilt, (frame, ids, x, y, int(step), self.name)


def _rebuilt(frame: Any, id: Any, x: Any, y: Any, step: int, name: str) -> Recording:
    return Recording(frame, id, x, y, frame_step=step, name=name)


def _column(values: ArrayLike, name: str) -> Floats:
    array = column(values, name)
    try:
        return np.require(array, np.float64, ["C", "A"])
    except (TypeError, ValueError) as error:
        raise ValueError(f"column {name} must hold numbers: {error}") from None


def read(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,
    fps: float | None = None,
    frame_step: int | None = None,
    homography: ArrayLike | None = None,
) -> Recording:
    """Read a file of tracks.

    Parameters
    ----------
    path
        csv with the header ``frame,pedestrian,x,y``, ndjson of TrajNet++, ``obsmat.txt`` of ETH, a file of Social-GAN or of STAR.
    format
        One of :data:`FORMATS`; otherwise it is told by the extension and the first lines.
    fps, frame_step
        As for :class:`Recording`.
    homography
        3 x 3, from pixels to metres, where positions are pixels.

    Raises
    ------
    FileNotFoundError, PermissionError
    ValueError
        The content is wrong: the message names the line and the field.
    """
    matrix = None if homography is None else np.asarray(homography, dtype=np.float64).tolist()
    return Recording._of(_core.Recording.read(path, format=format, fps=fps, frame_step=frame_step, homography=matrix))
