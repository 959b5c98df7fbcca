"""Recordings of tracks, read from and written to files or columns."""

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
    """Tracks of pedestrians in one place.

    Parameters
    ----------
    frame, id, x, y
        Columns of equal length, one row per position in any order: frame number, pedestrian (whole number or word), and
        metres. Lists, numpy arrays, pandas or polars columns.
    fps
        Frame numbers per second. Positions are interpolated linearly if 0.4 s is not a whole number of frames. Default:
        the most common difference of two frame numbers counts as 0.4 s.
    frame_step
        Frame numbers in 0.4 s, instead of ``fps``.
    name
        Name of the recording in results.

    Raises
    ------
    ValueError
        A value is missing or not finite (the message names row and column), or a frame has a pedestrian twice.

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
        """Name of the recording."""
        return self._core.name

    @property
    def frame_step(self) -> float:
        """Frame numbers in 0.4 s."""
        return self._core.frame_step

    @property
    def frame(self) -> NDArray[Any]:
        """Frame of each position, ascending; a fraction for interpolated positions."""
        return self._core.columns()[0]

    @property
    def id(self) -> NDArray[Any]:
        """Pedestrian of each position: whole numbers, or words."""
        return np.asarray(self._core.columns()[1])

    @property
    def x(self) -> Floats:
        """x of each position, metres."""
        return self._core.columns()[2]

    @property
    def y(self) -> Floats:
        """y of each position, metres."""
        return self._core.columns()[3]

    def doubt(self) -> str | None:
        """A fault that the speeds suggest, such as wrong units or a wrong rate; None without a fault."""
        return self._core.doubt()

    def write(self, path: str | os.PathLike[str], *, format: str = "table") -> None:
        """Write a file that :func:`read` restores position by position, in one of :data:`FORMATS`.

        The file is either complete or missing. Only ``table`` and ``trajnet`` can hold words as ids. No format holds
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
        csv with the header ``frame,pedestrian,x,y``, ndjson of TrajNet++, ``obsmat.txt`` of ETH, or a file of
        Social-GAN or of STAR.
    format
        One of :data:`FORMATS`; default: recognised by the extension and the first lines.
    fps, frame_step
        As for :class:`Recording`.
    homography
        3 x 3 matrix from pixels to metres, for positions in pixels.

    Raises
    ------
    FileNotFoundError, PermissionError
    ValueError
        The content is wrong: the message names the line and the field.
    """
    matrix = None if homography is None else np.asarray(homography, dtype=np.float64).tolist()
    return Recording._of(_core.Recording.read(path, format=format, fps=fps, frame_step=frame_step, homography=matrix))
