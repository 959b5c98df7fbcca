"""Conversion to the arrays of the compiled module: contiguous float64 or int64. Such arrays are not copied."""

from __future__ import annotations

from datetime import datetime, timezone
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


#: Larger whole numbers are not exact as float64. Words are numbered from here on.
LARGEST = 2**53


def floats(values: ArrayLike, dimensions: int, name: str, shape: str) -> Floats:
    """The values as float64 in C order; an error names the expected shape."""
    unmasked(values, name)
    try:
        array = np.require(values, np.float64, ["C", "A"])
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be an array of numbers of the shape {shape}: {error}") from None
    if array.ndim != dimensions:
        raise ValueError(f"{name} must have the shape {shape}; found {array.shape}")
    return array


def scene(past: ArrayLike, neighbours: ArrayLike | None) -> tuple[Floats, int]:
    """All pedestrians of a scene, and the number of those to forecast, which come first."""
    if np.ndim(past) == 2 and np.shape(past)[-1:] == (2,):
        hint = "for one pedestrian, give past[None]"
        raise ValueError(f"past must have the shape (n, 8, 2); found {np.shape(past)}; {hint}")
    array = floats(past, 3, "past", "(n, 8, 2)")
    if neighbours is None:
        return array, len(array)
    others = floats(neighbours, 3, "neighbours", "(m, 8, 2)")
    for name, found in (("past", array), ("neighbours", others)):
        if found.shape[1:] != (8, 2):
            raise ValueError(f"{name} must have the shape (n, 8, 2); found {found.shape}")
    return np.concatenate([array, others]), len(array)


def plan_rows(plan: ArrayLike) -> Floats:
    """(m, 4) rows of a plan: time, x, y and radius, which is 0 where it is not given."""
    rows = floats(plan, 2, "a plan", "(m, 3) or (m, 4)")
    return np.column_stack([rows, np.zeros(len(rows))]) if rows.shape[1] == 3 else rows


def numbered(ids: ArrayLike) -> tuple[Integers, list[str] | None]:
    """Ids as whole numbers, and the words from ``LARGEST`` on; None if the ids are whole numbers already."""
    array = column(ids, "id")
    if array.dtype.kind == "O" and all(type(one) is int or isinstance(one, np.integer) for one in array):
        array = array.astype(np.int64) if all(abs(one) < LARGEST for one in array) else array
    if array.dtype.kind in "iuf":
        return whole(array, "id"), None
    words = []
    for row, value in enumerate(array.tolist()):
        if isinstance(value, bool) or not isinstance(value, (str, int)):
            raise ValueError(
                f"row {row}, column id: {value!r} is neither a whole number nor a word (rows are counted from 0)"
            )
        words.append(str(value))
    known, coded = np.unique(np.array(words, dtype=np.str_), return_inverse=True)
    return LARGEST + np.ascontiguousarray(coded, dtype=np.int64).reshape(-1), known.tolist()


def whole(values: ArrayLike, name: str) -> Integers:
    """Whole numbers below 2^53 in size, such as frames; fractions are refused."""
    array = column(values, name)
    if array.dtype.kind not in "iuf":
        raise ValueError(
            f"column {name} must hold whole numbers; found the type {array.dtype} (text? convert it by astype(int))"
        )
    wrong = np.flatnonzero(~((np.abs(array.astype(np.float64)) < LARGEST) & (array == np.round(array))))
    if len(wrong):
        row = int(wrong[0])
        missing = "; leave out rows without it" if np.isnan(array[row]) else ""
        hint = missing or ("; count frames: 0, 1, 2, and so on, or give times as time=" if name == "frame" else "")
        raise ValueError(f"row {row}, column {name}: {array[row]} is not a whole number below 2^53 in size{hint}")
    return np.require(array, np.int64, ["C", "A"])


def moments(frame: ArrayLike | None, time: ArrayLike | None) -> tuple[Integers, str | None]:
    """Frames, or times in microseconds and their unit: ``seconds`` or ``dates``."""
    if (frame is None) == (time is None):
        raise ValueError("give frame or time, one of the two: frame numbers, or times in seconds or as datetimes")
    if frame is not None:
        return whole(frame, "frame"), None
    assert time is not None
    array = column(time, "time")
    if array.dtype.kind in "iuf":
        seconds = array.astype(np.float64)
        wrong = np.flatnonzero(~(np.abs(seconds) * 1e6 < LARGEST))
        if len(wrong):
            row = int(wrong[0])
            raise ValueError(f"row {row}, column time: {array[row]} is not a time in seconds, below 9e9 in size")
        return np.require(np.round(seconds * 1e6), np.int64, ["C", "A"]), "seconds"
    dates = _dates(array)
    missing = np.flatnonzero(np.isnat(dates))
    if len(missing):
        raise ValueError(f"row {int(missing[0])}, column time: the time is missing; leave out rows without it")
    return np.require(dates.astype("datetime64[us]").astype(np.int64), np.int64, ["C", "A"]), "dates"


def _dates(array: NDArray[Any]) -> NDArray[Any]:
    """Columns with a time zone, as of pandas, hold objects: they become UTC."""
    if array.dtype.kind == "O" and all(isinstance(one, datetime) for one in array):
        zoned = [one.astimezone(timezone.utc).replace(tzinfo=None) if one.tzinfo is not None else one for one in array]
        return np.array(zoned, dtype="datetime64[us]")
    if array.dtype.kind != "M":
        hint = "(text? pandas.to_datetime reads it)"
        raise ValueError(f"column time must hold seconds or datetimes; found the type {array.dtype} {hint}")
    return array


def column(values: ArrayLike, name: str) -> NDArray[Any]:
    """An array of one dimension."""
    unmasked(values, name)
    array = np.asarray(values)
    if array.ndim != 1:
        raise ValueError(f"column {name} must have one dimension; found the shape {array.shape}")
    return array


def unmasked(values: ArrayLike, name: str) -> None:
    """Refuse masked values, also in a list, because their masks would be ignored."""
    parts = values if isinstance(values, (list, tuple)) else [values]
    if any(isinstance(part, np.ma.MaskedArray) and np.ma.is_masked(part) for part in parts):
        raise ValueError(f"{name} has masked values: leave out these rows, or fill past with NaN")
