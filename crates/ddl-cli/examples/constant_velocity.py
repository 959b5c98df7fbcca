"""Forecasts with the velocity of the last observed step.

    ddl windows --convention star --fold zara1 --output windows.jsonl
    python3 constant_velocity.py windows.jsonl forecasts.jsonl
    ddl evaluate --forecasts forecasts.jsonl --convention star --fold zara1

Replace `forecast` with your own model.
"""

import json
import sys


def forecast(observed):
    """12 positions [x, y] in metres, 0.4 s apart, from the 8 observed ones."""
    (x7, y7), (x8, y8) = observed[-2:]
    vx, vy = x8 - x7, y8 - y7
    return [[x8 + t * vx, y8 + t * vy] for t in range(1, 13)]


with open(sys.argv[1]) as windows, open(sys.argv[2], "w") as forecasts:
    for line in windows:
        pedestrian = json.loads(line)
        answer = {key: pedestrian[key] for key in ("recording", "observed_until", "pedestrian")}
        # Several hypotheses are possible, with a "weight" each or of equal weight: the best of 20 counts.
        answer["hypotheses"] = [{"positions": forecast(pedestrian["observed"])}]
        forecasts.write(json.dumps(answer) + "\n")
