"""Makes the pages that check_page.py opens: make_page.py FOLDER PROGRAM

`ddl evaluate` scores a stand-in with six weighted goals on the simulated crowds, and `ddl report` joins the folds
into FOLDER/report.html and its data. `ddl view` makes FOLDER/viewer.html of the sample,
and FOLDER/joint.html with its joint futures.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

SAMPLE = pathlib.Path(__file__).parents[2] / "datasets/sample.csv"
FOLDS = ("corridor", "crossing", "plaza", "bottleneck", "doorway")
TURNS = (-30, 0, 30)  # degrees
SPEEDS = (0.6, 1.0)


def way(observed, goal):
    """12 positions that start with the observed velocity and bend to the goal, which they nearly reach."""
    before, last = observed[-2:]
    for t in range(1, 13):
        s = t / 12
        # A parabola that starts with the pedestrian's velocity, blended into the straight line.
        fade, along = s * s * (3 - 2 * s), 1 - (1 - s) ** 1.15
        inertia = [b + (b - a) * t for a, b in zip(before, last)]
        straight = [b + 0.985 * along * (g - b) for b, g in zip(last, goal)]
        yield [round((1 - fade) * i + fade * s, 3) for i, s in zip(inertia, straight)]


def hypotheses(observed):
    first, last = observed[3], observed[-1]
    ahead = [(b - a) * 3 for a, b in zip(first, last)]
    for turn in TURNS:
        sin, cos = math.sin(math.radians(turn)), math.cos(math.radians(turn))
        for speed in SPEEDS:
            turned = cos * ahead[0] - sin * ahead[1], sin * ahead[0] + cos * ahead[1]
            goal = [b + speed * step for b, step in zip(last, turned)]
            weight = math.exp(-((turn / 20) ** 2) - ((speed - 1) / 0.3) ** 2)
            yield {"weight": weight, "goal": goal, "positions": list(way(observed, goal))}


def forecast(line):
    pedestrian = json.loads(line)
    forecast = list(hypotheses(pedestrian.pop("observed")))
    total = sum(hypothesis["weight"] for hypothesis in forecast)
    for hypothesis in forecast:
        hypothesis["weight"] /= total
    return json.dumps(pedestrian | {"hypotheses": forecast}) + "\n"


def as_published(path):
    """The rows also under the protocol that a page warns of; a file's forecasts cannot be measured under it."""
    report = json.loads(path.read_text())
    fair = [row for row in report["rows"] if row["conditions"]["protocol"] == "fair"]
    report["rows"] += [row | {"conditions": row["conditions"] | {"protocol": "published"}} for row in fair]
    path.write_text(json.dumps(report))


def main():
    folder, program = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])

    def ddl(*arguments):
        return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout

    with tempfile.TemporaryDirectory() as temporary:
        work, results = pathlib.Path(temporary), []
        for fold in FOLDS:
            scene = ("--convention", "simulated", "--fold", fold, "--window-rule", "published")
            forecasts, evaluated = work / "forecasts.jsonl", work / fold
            lines = ddl("windows", *scene).splitlines()
            forecasts.write_text("".join(map(forecast, lines)))
            named = ("--forecasts", forecasts, "--name", "stand-in", "--protocol", "fair,single,joint")
            ddl("evaluate", *scene, *named, "--out", evaluated)
            as_published(evaluated / "report.json")
            results.append(evaluated)
        ddl("report", *results, "--title", "A stand-in on simulated crowds", "--out", folder)
    ddl("view", SAMPLE, "--moments", "8", "--no-open", "--output", folder / "viewer.html")
    ddl("view", SAMPLE, "--moments", "8", "--joint", "--no-open", "--output", folder / "joint.html")


if __name__ == "__main__":
    main()
