"""Forecasts in the formats of other programs.

    python other_formats.py tracks.csv FOLDER

writes the most likely forecast of the last frame as AgentFormer does, and prints the shapes of TrajNet++'s.
"""

import sys

import numpy as np
from ddl_forecast import Forecast, Forecaster, read
from numpy.typing import NDArray

Floats = NDArray[np.float64]
TrajNet = dict[int, tuple[Floats, Floats]]


def trajnet(forecast: Forecast, modes: int = 3) -> TrajNet:
    """TrajNet++: a dict of modes: the primary (12, 2), here the first pedestrian, and the neighbours (12, n - 1, 2)."""
    order = np.argsort(-forecast.weights[0])[:modes]
    paths = forecast.paths[:, order]
    return {mode: (paths[0, mode], np.moveaxis(paths[1:, mode], 0, 1)) for mode in range(modes)}


def agentformer(forecast: Forecast, folder: str, sample: int) -> str:
    """AgentFormer: one file per sample, rows of frame, id, x, y."""
    frames = forecast.frames
    assert frames is not None
    rows = [[t, one, *forecast.paths[i, sample, k]] for i, one in enumerate(forecast.ids) for k, t in enumerate(frames)]
    path = f"{folder}/sample_{sample:03}.txt"
    np.savetxt(path, rows, fmt="%g %g %.6f %.6f")
    return path


if __name__ == "__main__":
    tracks, folder = sys.argv[1:]
    forecast = Forecaster().forecast_recording(read(tracks))[-1]
    primary, neighbours = trajnet(forecast)[0]
    print(agentformer(forecast, folder, 0), primary.shape, neighbours.shape)
