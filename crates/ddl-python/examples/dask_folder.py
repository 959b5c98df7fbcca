"""Forecasts of a folder of recordings by Dask, on the cores of one machine or on a cluster.

    pip install ddl-forecast pandas "dask[distributed]"
    python dask_folder.py FOLDER OUT [SCHEDULER]

A task a file. Dask gives the tasks of a worker that died to another one; a result is a file that is there whole or not at all.
"""

import os
import sys
from pathlib import Path

from dask.distributed import Client, LocalCluster, as_completed
from forecast_file import forecast_file

import ddl_forecast as ddl


def forecast_folder(client: Client, folder: Path, out: Path, model: str = "hotel") -> list[str]:
    """Every csv of a folder. Worker processes load the model once each, from its name."""
    out.mkdir(exist_ok=True, parents=True)
    files = sorted(str(path) for path in folder.glob("*.csv"))
    tasks = client.map(forecast_file, files, out=str(out), forecaster=ddl.Forecaster(model), pure=False)
    return sorted(task.result() for task in as_completed(tasks))


def main() -> None:
    folder, out, *scheduler = sys.argv[1:]
    if scheduler:
        client = Client(scheduler[0])
    else:
        # a process a core, and a thread of the forecaster in each
        os.environ["RAYON_NUM_THREADS"] = "1"
        client = Client(LocalCluster(n_workers=os.cpu_count(), threads_per_worker=1))
    with client:
        for made in forecast_folder(client, Path(folder), Path(out)):
            print(made)


if __name__ == "__main__":
    main()
