"""What the compiled module takes: arrays of float64 or int64 in one piece. An array that is one already is not copied."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


def floats(values: ArrayLike, dimensions: int, name: str, shape: str) -> Floats:
    """The values as float64 in C order; an error names the shape that is expected."""
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be an array of numbers of the shape {shape}: {error}") from None
    if array.ndim != dimensions:
        raise ValueError(f"{name} must have the shape {shape}; found {array.shape}")
    return array


def scene(past: ArrayLike, neighbours: ArrayLike | None) -> tuple[Floats, int]:
    """Everybody of a scene, and how many of them are to be forecast: the first."""
    array = floats(past, 3, "past", "(n, 8, 2)")
    if neighbours is None:
        return array, len(array)
    others = floats(neighbours, 3, "neighbours", "(m, 8, 2)")
    if others.shape[1:] != array.shape[1:]:
        raise ValueError(f"neighbours must have the shape (m, 8, 2); found {others.shape}")
    return np.concatenate([array, others]), len(array)


def numbered(ids: ArrayLike) -> tuple[Integers, list[str] | None]:
    """Pedestrians as whole numbers, and the word that each number stands for; nothing where they are whole numbers already."""
    array = np.asarray(ids)
    if array.dtype.kind in "iu":
        return np.ascontiguousarray(array, dtype=np.int64), None
    if array.dtype.kind == "f":
        return whole(array, "id"), None
    words, coded = np.unique(array.astype(np.str_), return_inverse=True)
    return np.ascontiguousarray(coded, dtype=np.int64).reshape(-1), words.tolist()


def whole(values: ArrayLike, name: str) -> Integers:
    """Whole numbers, such as frames; fractions are refused."""
    array = np.asarray(values)
    if array.dtype.kind in "iu":
        return np.ascontiguousarray(array, dtype=np.int64)
    try:
        numbers = np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"column {name} must hold whole numbers: {error}") from None
    wrong = np.flatnonzero(~(numbers == np.round(numbers)))
    if len(wrong):
        row = int(wrong[0])
        raise ValueError(f"row {row}, column {name}: {numbers.flat[row]} is not a whole number; count frames: 0, 1, 2, and so on")
    return np.ascontiguousarray(numbers, dtype=np.int64)
