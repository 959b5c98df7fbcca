"""The forecasts of one recording: what an engine runs many of."""

import os
from pathlib import Path

import pandas as pd

import ddl_forecast as ddl


def forecast_file(path: str, out: str, forecaster: ddl.Forecaster) -> str:
    """The forecasts of one recording as a csv table, with all digits."""
    columns = forecaster.forecast_table(*(pd.read_csv(path)[name] for name in ("frame", "pedestrian", "x", "y")))
    made = Path(out) / Path(path).name
    hidden = made.with_name(f".{made.name}.{os.getpid()}")
    pd.DataFrame(columns).to_csv(hidden, index=False)
    hidden.replace(made)
    return str(made)
