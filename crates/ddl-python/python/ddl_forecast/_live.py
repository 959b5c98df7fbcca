"""Forecasts of a place that is watched."""

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


#: What is known by a word is numbered from here on.
FIRST_WORD = 2**52
#: Words that are remembered: far more than anybody who may still be there.
MOST_WORDS = 100_000


class Live:
    """Forecasts frame by frame, of one camera or robot.

    Forecasts have the bits of :meth:`Forecaster.forecast_recording` of the same frames, but for regions, which follow what is seen so
    that they hold their share in this place too.

    Parameters
    ----------
    forecaster
        One may serve several places.
    fps
        Frame numbers in a second, of which 0.4 s must be a whole number: 2.5, 5, 10, 12.5, 25 for instance.
    memory
        File of a scene memory: what earlier pedestrians did in this place counts in the forecasts. It is made where there is none, and
        written as frames come, about every minute, and by :meth:`close`. A memory of another place is found out by the first
        pedestrians: a warning is given, and the file is left as it is.
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
            raise TypeError(f"forecaster must be a Forecaster, such as Forecaster('hotel'); found {type(forecaster).__name__}")
        self._core = _core.Live(forecaster._core, fps, memory, whole, certificates)
        self._numbers: dict[str, int] = {}
        self._words: dict[int, str] = {}
        self._next = FIRST_WORD
        self._turn = threading.Lock()
        self._told = False
        self._doubted = False

    def observe(self, frame: int, ids: Iterable[Hashable], xy: ArrayLike) -> Forecast | None:
        """Add a frame, which must come after the last one, and forecast from it.

        Parameters
        ----------
        frame
            Its number. A frame that is left out is a gap.
        ids
            Who is there: n whole numbers or words, the same for the same pedestrian in every frame.
        xy
            (n, 2) positions, metres.

        Returns
        -------
        A forecast of everybody seen now and often enough before; None while that is nobody.

        Raises
        ------
        ValueError
            A frame out of order, somebody twice, or a position that is not finite. Nothing has changed then: the frame may be given
            again without it.
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
            warnings.warn(f"the memory was not written and is tried again in a minute: {unwritten}", stacklevel=2)
        if parts is None:
            return None
        forecast = Forecast._of(parts, names)
        doubt = None if self._doubted else forecast.unfamiliar()
        if doubt is not None:
            self._doubted = True
            warnings.warn(f"frame {frame}: {doubt}; this is told once", DoubtWarning, stacklevel=2)
        return forecast

    def _number(self, one: Hashable) -> int:
        """Numbers as they are, words from a place on where no tracker counts."""
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
        """Words of pedestrians who have gone, so that a stream of days stays small: all but those of the last frames."""
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
            warnings.warn(f"{why}; its file stays as it is", stacklevel=3)

    @property
    def remembered(self) -> int:
        """Stretches of 3.2 s and more that are remembered of the place; 0 without a memory."""
        return self._core.remembered()

    def clear(self) -> None:
        """Forget who is there, as when a tracker starts anew: any frame may come next. The memory stays."""
        self._core.clear()

    def close(self) -> None:
        """Write the memory and let go of its file; a warning tells where it stays as it was. Without a memory nothing happens."""
        why = self._core.close()
        if why is not None and not self._told:
            self._told = True
            warnings.warn(why, stacklevel=2)

    def __enter__(self) -> Live:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()
