"""Many cameras in one process over Zenoh: it receives tracks and publishes forecasts.

    pip install ddl-forecast eclipse-zenoh
    python zenoh_cameras.py [--model world] [--memory FOLDER] [--connect tcp/HOST:7447] [--listen tcp/HOST:7447]

A tracker publishes each frame of camera NAME on the key `tracks/NAME` as JSON, positions in metres:
{"frame": 12, "fps": 2.5, "ids": [1, 2], "xy": [[0.1, 2.0], [3.4, 1.0]]}. The answer is published on `forecasts/NAME`:
{"frame": 12, "ids": [...], "paths": [n][20][12][2], "weights": [n][20]}, with empty lists until a pedestrian has been
observed long enough, or {"frame": 12, "error": "..."}. The frames of a camera must arrive in order.
"""

import argparse
import json
import sys
import threading
from pathlib import Path

import ddl_forecast as ddl
import zenoh


class Cameras:
    """Live forecasts of each camera, by name."""

    def __init__(self, model: str, memory: Path | None) -> None:
        self.forecaster = ddl.Forecaster(model)
        self.memory = memory
        self.watches: dict[str, ddl.Live] = {}

    def answer(self, name: str, payload: bytes) -> dict[str, object]:
        """The forecast from one frame of a camera, or its error."""
        frame: object = None
        try:
            seen = json.loads(payload)
            frame = seen["frame"]
            forecast = self.watch(name, seen["fps"]).observe(seen["frame"], seen["ids"], seen["xy"])
        except (KeyError, TypeError, ValueError, OverflowError, OSError) as error:
            return {"frame": frame, "error": f"{type(error).__name__}: {error}"}
        if forecast is None:
            return {"frame": frame, "ids": [], "paths": [], "weights": []}
        return {
            "frame": frame,
            "ids": forecast.ids.tolist(),
            "paths": forecast.paths.round(4).tolist(),
            "weights": forecast.weights.tolist(),
        }

    def watch(self, name: str, fps: float) -> ddl.Live:
        if name not in self.watches:
            file = None if self.memory is None else self.memory / f"{name}.memory"
            self.watches[name] = ddl.Live(self.forecaster, fps=fps, memory=file)
        return self.watches[name]

    def close(self) -> None:
        for name, watch in self.watches.items():
            try:
                watch.close()
            except OSError as error:
                print(f"{name}: {error}", file=sys.stderr)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--model", default="world")
    arguments.add_argument("--memory", type=Path)
    arguments.add_argument("--connect")
    arguments.add_argument("--listen")
    told = arguments.parse_args()
    cameras = Cameras(told.model, told.memory)
    config = zenoh.Config()
    for end in ("connect", "listen"):
        if getattr(told, end):
            config.insert_json5(f"{end}/endpoints", json.dumps([getattr(told, end)]))
    with zenoh.open(config) as session:

        def heard(sample: zenoh.Sample) -> None:
            name = str(sample.key_expr).removeprefix("tracks/")
            answer = cameras.answer(name, sample.payload.to_bytes())
            session.put(f"forecasts/{name}", json.dumps(answer))

        subscriber = session.declare_subscriber("tracks/**", heard)
        print("watching tracks/**", flush=True)
        try:
            threading.Event().wait()
        except KeyboardInterrupt:
            subscriber.undeclare()
            cameras.close()


if __name__ == "__main__":
    main()
