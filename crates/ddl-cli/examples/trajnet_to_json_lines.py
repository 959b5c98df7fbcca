"""JSON lines for `ddl evaluate --forecasts` from forecasts in TrajNet++ ndjson.

    python3 trajnet_to_json_lines.py forecasts.ndjson forecasts.jsonl

A neighbour's forecast counts where no scene has it as its primary pedestrian.
"""

import json
import sys

scenes, forecasts, answers = {}, {}, {}
with open(sys.argv[1]) as lines:
    for line in map(json.loads, lines):
        track = line.get("track", {})
        if "scene" in line:
            scenes[line["scene"]["id"]] = line["scene"]
        elif track.get("prediction_number") is not None:
            hypotheses = forecasts.setdefault((track["scene_id"], track["p"]), {})
            hypotheses.setdefault(track["prediction_number"], []).append((track["f"], track["x"], track["y"]))
# Primary pedestrians come last and replace neighbours.
for scene, pedestrian in sorted(forecasts, key=lambda key: key[1] == scenes[key[0]]["p"]):
    hypotheses = forecasts[scene, pedestrian]
    paths = [sorted(hypotheses[number]) for number in sorted(hypotheses)]
    frames = [frame for frame, _, _ in paths[0]]
    answer = {"observed_until": 2 * frames[0] - frames[1], "pedestrian": pedestrian, "frames": frames}
    answer |= {key: scenes[scene][key] for key in ["recording"] if key in scenes[scene]}
    answer["hypotheses"] = [{"positions": [[x, y] for _, x, y in path]} for path in paths]
    answers[answer.get("recording"), answer["observed_until"], pedestrian] = json.dumps(answer)
with open(sys.argv[2], "w") as file:
    file.writelines(answer + "\n" for answer in answers.values())
