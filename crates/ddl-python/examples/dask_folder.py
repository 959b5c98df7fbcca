"""Forecasts of a folder of recordings with Dask, on one machine or on a cluster.

    pip install ddl-forecast pandas "dask[distributed]"
    python dask_folder.py FOLDER OUT [SCHEDULER]

One task for each file. Dask repeats the tasks of a worker that died; a result file is either complete or missing.
"""

import os
import sys
from pathlib import Path

import ddl_forecast as ddl
from dask.distributed import Client, LocalCluster, as_completed
from forecast_file import forecast_file


def forecast_folder(client: Client, folder: Path, out: Path, model: str = "world") -> list[str]:
    """Forecast every csv file of a folder. Each worker process loads the model once, from its name."""
    out.mkdir(exist_ok=True, parents=True)
    files = sorted(str(path) for path in folder.glob("*.csv"))
    tasks = client.map(forecast_file, files, out=str(out), forecaster=ddl.Forecaster(model), pure=False)
    return sorted(task.result() for task in as_completed(tasks))


def main() -> None:
    folder, out, *scheduler = sys.argv[1:]
    if scheduler:
        client = Client(scheduler[0])
    else:
        # one process per core, with one thread of the forecaster in each
        os.environ["RAYON_NUM_THREADS"] = "1"
        client = Client(LocalCluster(n_workers=os.cpu_count(), threads_per_worker=1))
    with client:
        for made in forecast_folder(client, Path(folder), Path(out)):
            print(made)


if __name__ == "__main__":
    main()
