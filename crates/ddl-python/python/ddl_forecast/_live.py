"""Live forecasts of a watched place."""

from __future__ import annotations

import operator
import os
import threading
import warnings
from collections.abc import Hashable, Iterable
from types import TracebackType

import numpy as np
from numpy.typing import ArrayLike

from ddl_forecast import _core
from ddl_forecast._arrays import Integers, floats
from ddl_forecast._forecast import DoubtWarning, Forecast
from ddl_forecast._forecaster import Forecaster

#: Words are numbered from here on.
FIRST_WORD = 2**52
#: Number of words that are kept: far more than pedestrians can be present.
MOST_WORDS = 100_000


class Live:
    """Forecasts for each frame of one camera or robot.

    Forecasts have the bits of :meth:`Forecaster.forecast_recording` on the same frames, except for regions, which adapt
    to the observations so that they keep their share in this place too.

    Parameters
    ----------
    forecaster
        A forecaster can serve several places.
    fps
        Frame numbers per second; 0.4 s must be a whole number of frames, as for 2.5, 5, 10, 12.5 or 25.
    memory
        File of a scene memory, through which the paths of earlier pedestrians of this place influence the forecasts. It
        is created if missing, written about every minute while frames arrive, and written by :meth:`close`. The first
        pedestrians show whether a memory is of another place: then a warning is given, and the file is left unchanged.
    whole, certificates
        As for :meth:`Forecaster.forecast`.

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
        fps: float,
        memory: str | os.PathLike[str] | None = None,
        whole: bool = False,
        certificates: bool = False,
    ) -> None:
        if not isinstance(forecaster, Forecaster):
            raise TypeError(
                f"forecaster must be a Forecaster, such as Forecaster('hotel'); found {type(forecaster).__name__}"
            )
        self._core = _core.Live(forecaster._core, fps, memory, whole, certificates)
        self._numbers: dict[str, int] = {}
        self._words: dict[int, str] = {}
        self._next = FIRST_WORD
        self._turn = threading.Lock()
        self._told = False
        self._doubted = False

    def observe(self, frame: int, ids: Iterable[Hashable], xy: ArrayLike) -> Forecast | None:
        """Add a frame, which must be later than the last one, and forecast from it.

        Parameters
        ----------
        frame
            Its number. A missing frame is a gap.
        ids
            Ids of the n pedestrians: whole numbers or words, which must not change from frame to frame.
        xy
            (n, 2) positions, metres.

        Returns
        -------
        A forecast of all pedestrians observed in this frame and often enough before; None without such pedestrians.

        Raises
        ------
        ValueError
            A frame out of order, a repeated pedestrian, or a position that is not finite. The state is then unchanged:
            the frame may be given again without the fault.
        """
        people = list(ids)
        positions = np.empty((0, 2)) if len(people) == 0 and np.size(xy) == 0 else floats(xy, 2, "xy", "(n, 2)")
        with self._turn:
            numbers = np.array([self._number(one) for one in people], dtype=np.int64)
            parts, unwritten = self._core.observe(operator.index(frame), numbers, positions)
            self._forget(numbers)
            words = self._words
            names = None if parts is None else [words.get(one, one) for one in parts["ids"]]
        self._tell_refusal()
        if unwritten is not None:
            warnings.warn(
                f"the memory could not be written, the next attempt follows in a minute: {unwritten}", stacklevel=2
            )
        if parts is None:
            return None
        forecast = Forecast._of(parts, names)
        doubt = None if self._doubted else forecast.unfamiliar()
        if doubt is not None:
            self._doubted = True
            warnings.warn(f"frame {frame}: {doubt}; this warning appears once", DoubtWarning, stacklevel=2)
        return forecast

    def _number(self, one: Hashable) -> int:
        """Numbers are kept; words get numbers beyond those of trackers."""
        if isinstance(one, (int, np.integer)) and not isinstance(one, bool):
            number = int(one)
            if abs(number) >= FIRST_WORD:
                raise ValueError(f"the id {one} is not below 2^52 in size; give it as a word")
            return number
        if not isinstance(one, str):
            raise ValueError(f"the id {one!r} is neither a whole number nor a word")
        if one not in self._numbers:
            self._numbers[one] = self._next
            self._words[self._next] = one
            self._next += 1
        return self._numbers[one]

    def _forget(self, seen: Integers) -> None:
        """Drop the words of pedestrians who left before the last frames, so that a long stream needs little memory."""
        if len(self._words) <= MOST_WORDS:
            return
        keep = {int(one) for one in seen}
        for number in list(self._words)[: len(self._words) - MOST_WORDS // 2]:
            if number not in keep:
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
