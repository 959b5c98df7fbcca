"""Forecasts of a folder of recordings with Ray.

pip install ddl-forecast pandas ray
python ray_folder.py FOLDER OUT
"""

import sys
from pathlib import Path

import ddl_forecast as ddl
import ray
from forecast_file import forecast_file

if __name__ == "__main__":
    folder, out = Path(sys.argv[1]), Path(sys.argv[2])
    out.mkdir(exist_ok=True, parents=True)
    ray.init(runtime_env={"env_vars": {"RAYON_NUM_THREADS": "1"}})
    model = ray.put(ddl.Forecaster())
    task = ray.remote(forecast_file)
    for made in ray.get([task.remote(str(path), str(out), model) for path in sorted(folder.glob("*.csv"))]):
        print(made)
