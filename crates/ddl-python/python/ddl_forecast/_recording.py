"""Recordings of tracks, read from and written to files or columns."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddl_forecast import _core
from ddl_forecast._arrays import Floats, column, moments, numbered
from ddl_forecast._forecast import DoubtWarning

#: Formats of files of tracks that are read and written, by name.
WRITTEN = ("table", "trajnet", "social-gan", "star-csv", "obsmat")
#: Formats that are read.
FORMATS = (
    *(*WRITTEN, "id-first", "petrack", "petrack-cm", "sdd", "mot", "mot-truth", "atc", "kitti", "apolloscape"),
    *("vsp", "edinburgh"),
)


class Recording:
    """Tracks of pedestrians in one place.

    Parameters
    ----------
    frame, id, x, y
        Columns of equal length, one row per position in any order: frame number, pedestrian (whole number or word), and
        metres. Lists, numpy arrays, pandas or polars columns.
    time
        Times instead of ``frame``: seconds as numbers, or datetimes of numpy, pandas or polars (in UTC where they have
        a time zone). They are rounded to microseconds.
    fps
        Frame numbers per second, such as 25, 7 or 23.976. Default: the most common difference of two rows of a
        pedestrian counts as 0.4 s.
    frame_step
        Frame numbers in 0.4 s, instead of ``fps``.
    name
        Name of the recording in results.

    Raises
    ------
    ValueError
        A value is missing or not finite (the message names row and column), a frame has a pedestrian twice, or the rows
        of a pedestrian are more than 1.2 s apart.

    Examples
    --------
    >>> recording = Recording([0, 10, 0, 10], [1, 1, 2, 2], [0.0, 0.5, 3.0, 2.5], [0.0, 0.0, 1.0, 1.0], fps=25)
    >>> recording
    Recording('recording', 2 pedestrians, 2 frames, 4 positions)
    """

    def __init__(
        self,
        frame: ArrayLike | None = None,
        id: ArrayLike = (),
        x: ArrayLike = (),
        y: ArrayLike = (),
        *,
        time: ArrayLike | None = None,
        fps: float | None = None,
        frame_step: int | None = None,
        name: str = "recording",
    ) -> None:
        numbers, unit = moments(frame, time)
        ids, words = numbered(id)
        self._core = _core.Recording(numbers, unit, ids, _column(x, "x"), _column(y, "y"), words, fps, frame_step, name)

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
        """Frame numbers in 0.4 s; for times, 0.4 s in their unit."""
        return self._core.frame_step

    @property
    def frame(self) -> NDArray[Any]:
        """Frame or time of each position as in the file, ascending."""
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
        """Write a file that :func:`read` restores position by position, in one of :data:`WRITTEN`.

        The file is either complete or missing. Only ``table`` and ``trajnet`` can hold words as ids, or times. No
        format holds ``fps``: give it to :func:`read` again.
        """
        self._core.write(path, format=format)

    def __len__(self) -> int:
        return len(self._core)

    def __repr__(self) -> str:
        return repr(self._core).replace('"', "'")

    def __reduce__(self) -> tuple[Any, ...]:
        core = self._core
        step = int(core.frame_step) if core.fps is None and core.unit is None else None
        return _rebuilt, (core.numbers(), core.unit, *core.columns()[1:], core.fps, step, core.name)


def _rebuilt(
    numbers: Any, unit: str | None, id: Any, x: Any, y: Any, fps: float | None, step: int | None, name: str
) -> Recording:
    ids, words = numbered(id)
    return Recording._of(_core.Recording(numbers, unit, ids, x, y, words, fps, step, name))


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
    columns: Mapping[str, str] | None = None,
    keep: Mapping[str, str] | None = None,
    unit: str | None = None,
) -> Recording:
    """Read a file of tracks. What is assumed or left out is a :class:`DoubtWarning`.

    Parameters
    ----------
    path
        A table with a header that names frame (or time), pedestrian, x and y by their usual names, or a file of one of
        :data:`FORMATS`.
    format
        One of :data:`FORMATS`; default: recognised by the extension and the first lines.
    fps, frame_step
        As for :class:`Recording`; only for frame numbers.
    homography
        3 x 3 matrix from pixels to metres, for positions in pixels.
    columns
        Columns by role (``frame`` or ``time``, ``pedestrian``, ``x``, ``y``, ``left``, ``top``, ``right``, ``bottom``,
        ``width``, ``height``, ``class``), where their names do not say it: ``{"x": "east", "y": "north"}``.
    keep
        Only rows with this value in a column: ``{"class": "Pedestrian"}``.
    unit
        Unit of the positions: ``"m"``, ``"cm"``, ``"mm"`` or ``"px"``; default: that in the names of the columns, or m.

    Raises
    ------
    FileNotFoundError, PermissionError
    ValueError
        The content is wrong: the message names the line and the field.
    """
    matrix = None if homography is None else np.asarray(homography, dtype=np.float64).tolist()
    if keep is not None and len(keep) != 1:
        raise ValueError(f"keep names one column and its value, found {len(keep)}")
    pairs = [None if given is None else ",".join(map("=".join, given.items())) for given in (columns, keep)]
    rows = _core.Recording.read(
        path, format=format, rate=(fps, frame_step), homography=matrix, choice=(pairs[0], pairs[1], unit)
    )
    for note in rows.notes:
        warnings.warn(f"{rows.name}: {note}", DoubtWarning, stacklevel=2)
    return Recording._of(rows)
