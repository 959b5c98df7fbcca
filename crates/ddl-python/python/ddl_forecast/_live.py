"""Live forecasts of a watched place."""

from __future__ import annotations

import operator
import os
import threading
import warnings
from collections.abc import Hashable, Iterable
from datetime import datetime
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ddl_forecast import _core
from ddl_forecast._arrays import LARGEST, floats, moments
from ddl_forecast._forecast import DoubtWarning, Forecast
from ddl_forecast._forecaster import Forecaster

#: Number of words that are kept: far more than pedestrians can be present.
MOST_WORDS = 100_000


class Live:
    """Forecasts for each frame of one camera or robot.

    Forecasts have the bits of :meth:`Forecaster.forecast_recording` on the same rows (with words as ids, their values
    up to rounding), except for regions and weights, which adapt to the observations so that they keep their share in
    this place too (those of joint futures do not).

    Parameters
    ----------
    forecaster
        A forecaster can serve several places.
    fps
        Frame numbers per second, such as 25, 7 or 23.976; None if frames have times instead.
    memory
        File of a scene memory, through which the paths of earlier pedestrians of this place influence the forecasts. It
        is created if missing, written about every minute while frames arrive, and written by :meth:`close`. The first
        pedestrians show whether a memory is of another place: then a warning is given, and the file is left unchanged.
    every
        Least time between two forecasts, seconds; 0: at every frame.
    whole, max_age, certificates, joint
        As for :meth:`Forecaster.forecast_recording`.

    Examples
    --------
    >>> with Live(Forecaster(), fps=2.5) as live:
    ...     for frame in range(8):
    ...         forecast = live.observe(frame, ["ann", "bob"], [[0.5 * frame, 0.0], [9.0 - 0.5 * frame, 1.0]])
    >>> forecast.ids.tolist(), forecast.frames.tolist()[:2]
    (['ann', 'bob'], [8, 9])
    """

    def __init__(
        self,
        forecaster: Forecaster,
        *,
        fps: float | None = None,
        memory: str | os.PathLike[str] | None = None,
        whole: bool = False,
        max_age: float | None = None,
        every: float = 0.0,
        certificates: bool = False,
        joint: bool = False,
    ) -> None:
        if not isinstance(forecaster, Forecaster):
            raise TypeError(
                f"forecaster must be a Forecaster, such as Forecaster('world'); found {type(forecaster).__name__}"
            )
        self._core = _core.Live(forecaster._core, fps, memory, whole, max_age, every, certificates, joint)
        self._joint = joint
        self._has_times = fps is None
        self._numbers: dict[str, int] = {}
        self._words: dict[int, str] = {}
        self._next = LARGEST
        self._turn = threading.Lock()
        self._told = False
        self._doubts: set[str] = set()

    def observe(
        self,
        frame: int | None = None,
        ids: Iterable[Hashable] = (),
        xy: ArrayLike = (),
        *,
        time: float | np.datetime64 | datetime | None = None,
    ) -> Forecast | None:
        """Add a frame, which must be later than the last one, and forecast from it.

        Parameters
        ----------
        frame
            Its number. A missing frame is a gap.
        time
            Its time instead of its number, without ``fps``: seconds, or a datetime.
        ids
            Ids of the n pedestrians: whole numbers or words, which must not change from frame to frame.
        xy
            (n, 2) positions, metres.

        Returns
        -------
        A forecast of all pedestrians observed now or a little before; None without such pedestrians, or earlier
        than ``every`` allows.

        Raises
        ------
        ValueError
            A frame out of order, a repeated pedestrian, or a position that is not finite. The state is then unchanged:
            the frame may be given again without the fault.
        """
        number, unit = self._moment(frame, time)
        people = list(ids)
        positions = np.empty((0, 2)) if len(people) == 0 and np.size(xy) == 0 else floats(xy, 2, "xy", "(n, 2)")
        with self._turn:
            numbers = np.array([self._number(one) for one in people], dtype=np.int64)
            words = {number: self._words[number] for number in numbers.tolist() if number >= LARGEST}
            parts, misfits, unwritten = self._core.observe(number, unit, numbers, positions, words)
            misfit = None if not misfits else (self._words.get(misfits[0][0], misfits[0][0]), *misfits[0][1:])
            self._forget({*people, *(() if parts is None else parts["ids"])})
        self._tell_refusal()
        if unwritten is not None:
            warnings.warn(
                f"the memory could not be written, the next attempt follows in a minute: {unwritten}", stacklevel=2
            )
        forecast = None if parts is None else Forecast._of(parts, joint=self._joint)
        wrong = None
        if misfit is not None:
            wrong = (
                f"pedestrian {misfit[0]} is {misfit[1]:.1f} m from where it was expected; check that positions are in "
                "metres. Such positions are left out until others agree with them"
            )
        unfamiliar = None if forecast is None else forecast.unfamiliar()
        now = f"frame {frame}" if time is None else f"time {time}"
        of_wrong = now if misfit is None else misfit[2]
        for kind, moment, doubt in (("wrong", of_wrong, wrong), ("unfamiliar", now, unfamiliar)):
            if doubt is not None and kind not in self._doubts:
                self._doubts.add(kind)
                warnings.warn(f"{moment}: {doubt}; this warning appears once", DoubtWarning, stacklevel=2)
        return forecast

    def _moment(self, frame: int | None, time: float | np.datetime64 | datetime | None) -> tuple[int, str | None]:
        """A frame number, or a time in microseconds and its unit."""
        if self._has_times and frame is not None:
            raise ValueError("a frame number needs Live(..., fps=...), the frame numbers per second; else give time=")
        if not self._has_times and time is not None:
            raise ValueError("with fps frames have numbers: give frame instead of time, or leave out fps")
        if frame is not None and time is None:
            return operator.index(frame), None
        column: Any = None if time is None else [time]
        times, unit = moments(None, column)
        return int(times[0]), unit

    def _number(self, one: Hashable) -> int:
        """Numbers are kept; words get numbers beyond those of trackers."""
        if isinstance(one, (int, np.integer)) and not isinstance(one, bool):
            number = int(one)
            if abs(number) >= LARGEST:
                raise ValueError(f"the id {one} is not below 2^53 in size; give it as a word")
            return number
        if not isinstance(one, str):
            raise ValueError(f"the id {one!r} is neither a whole number nor a word")
        if one not in self._numbers:
            self._numbers[one] = self._next
            self._next += 1
        number = self._numbers[one]
        # In the order in which they were last seen.
        self._words.pop(number, None)
        self._words[number] = one
        return number

    def _forget(self, keep: set[Hashable]) -> None:
        """Drop the words of pedestrians who left before the last frames, so that a long stream needs little memory."""
        if len(self._words) <= MOST_WORDS:
            return
        for number in list(self._words)[: len(self._words) - MOST_WORDS // 2]:
            if self._words[number] not in keep:
                del self._numbers[self._words.pop(number)]

    def _tell_refusal(self) -> None:
        why = None if self._told else self._core.refused()
        if why is not None:
            self._told = True
            warnings.warn(f"{why}; its file is unchanged", stacklevel=3)

    @property
    def remembered(self) -> int:
        """Number of remembered segments of 3.2 s and more; 0 without a memory."""
        return self._core.remembered()

    def clear(self) -> None:
        """Forget all tracks, as when a tracker restarts: any frame may follow. The memory is kept."""
        self._core.clear()

    def close(self) -> None:
        """Write the memory, if there is one, and close its file; a warning tells if the file is left unchanged."""
        why = self._core.close()
        if why is not None and not self._told:
            self._told = True
            warnings.warn(why, stacklevel=2)

    def __enter__(self) -> Live:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
