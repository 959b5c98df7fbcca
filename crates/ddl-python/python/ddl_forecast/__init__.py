"""Forecasts of pedestrians, along stable paths to their goals.

Positions are in metres, time steps 0.4 s. The input are 8 observed positions (3.2 s); the output are 20 weighted
hypotheses of 12 positions (4.8 s).

>>> import numpy as np
>>> from ddl_forecast import Forecaster
>>> past = np.stack([np.linspace([0, 0], [3.5, 0], 8)])  # one pedestrian, 1.25 m/s along x
>>> forecast = Forecaster().forecast(past)
>>> forecast.paths.shape
(1, 20, 12, 2)
>>> bool(forecast.certified.all())
True
"""

from ddl_forecast import baselines, dynamics, goals, metrics, soft_dtw
from ddl_forecast._core import __version__, set_num_threads
from ddl_forecast._evaluation import Results, Window, evaluate, windows
from ddl_forecast._forecast import Certificates, DoubtWarning, Forecast, Occupancy, Risk, write_forecasts
from ddl_forecast._forecaster import Forecaster
from ddl_forecast._live import Live
from ddl_forecast._recording import Recording, read

__all__ = [
    "Certificates",
    "DoubtWarning",
    "Forecast",
    "Forecaster",
    "Live",
    "Occupancy",
    "Recording",
    "Results",
    "Risk",
    "Window",
    "__version__",
    "baselines",
    "dynamics",
    "evaluate",
    "goals",
    "metrics",
    "read",
    "set_num_threads",
    "soft_dtw",
    "windows",
    "write_forecasts",
]
