"""The forecasts of one recording: the task that the examples for Dask and Ray run many times."""

import os
from pathlib import Path

import ddl_forecast as ddl
import pandas as pd


def forecast_file(path: str, out: str, forecaster: ddl.Forecaster) -> str:
    """Write the forecasts of one recording as a csv table, with all digits."""
    tracks = pd.read_csv(path, float_precision="round_trip")
    columns = forecaster.forecast_table(tracks.frame, tracks.pedestrian, tracks.x, tracks.y)
    made = Path(out) / Path(path).name
    hidden = made.with_name(f".{made.name}.{os.getpid()}")
    pd.DataFrame(columns).to_csv(hidden, index=False)
    hidden.replace(made)
    return str(made)
