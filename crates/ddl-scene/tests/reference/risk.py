# Writes risk.json: risks and clearances of scenes like those of src/fixture.rs by Monte Carlo, with numpy 2.4.6: a
# million deviations of every pedestrian in every future. `python3 risk.py` in this folder.
import json

import numpy as np

DRAWS = 1_000_000


def least_distances(start, velocity, scale, plan, z):
    """Least distance of each draw from the middle of the plan during each of 12 steps."""
    rows = np.asarray(plan)
    least = []
    for step in range(12):
        ends = []
        for t in (step, step + 1):
            at = np.array([np.interp(0.4 * t, rows[:, 0], rows[:, axis]) for axis in (1, 2)])
            ends.append(np.asarray(start) + 0.4 * t * np.asarray(velocity) - at + scale * t / 12 * z)
        way = ends[1] - ends[0]
        share = np.clip(-(ends[0] * way).sum(1) / (way * way).sum(1), 0, 1)[:, None]
        least.append(np.linalg.norm(ends[0] + share * way, axis=1))
    return np.array(least)


def scene(rng):
    n, k = 3, 4
    weights = rng.dirichlet(np.ones(k))
    case = {
        "starts": rng.uniform(-4, 4, (n, 2)).tolist(),
        "velocities": rng.uniform(-1.2, 1.2, (n, k, 2)).tolist(),
        "weights": weights.tolist(),
        "scales": rng.uniform(0.1, 1.0, n).tolist(),
        "plan": [[time, *rng.uniform(-2, 2, 2), 0.3] for time in (0, 2.4, 4.8)],
        "within": float(rng.uniform(0.1, 0.6)),
    }
    reach = case["within"] + 0.3
    nearest, steps, until = 0, np.zeros(12), np.zeros(12)
    pedestrians, clearances = np.zeros(n), np.zeros(n)
    for future in range(k):
        close, far = np.zeros((12, DRAWS), bool), np.full(DRAWS, np.inf)
        for i in range(n):
            z = rng.standard_normal((DRAWS, 2)) * np.sqrt(3 / rng.chisquare(3, DRAWS))[:, None]
            least = least_distances(
                case["starts"][i], case["velocities"][i][future], case["scales"][i], case["plan"], z
            )
            close |= least <= reach
            edge = np.maximum(least.min(0) - 0.3, 0)
            far = np.minimum(far, edge)
            pedestrians[i] += weights[future] * (least <= reach).any(0).mean()
            clearances[i] += weights[future] * edge.mean()
        steps += weights[future] * close.mean(1)
        until += weights[future] * np.logical_or.accumulate(close).mean(1)
        nearest += weights[future] * far.mean()
    case |= {"pedestrians": pedestrians, "steps": steps, "until": until, "clearances": clearances, "nearest": nearest}
    return {name: np.round(value, 4).tolist() if name in list(case)[6:] else value for name, value in case.items()}


rng = np.random.default_rng(1)
with open("risk.json", "w") as file:
    file.write("[\n" + ",\n".join(json.dumps(scene(rng)) for _ in range(4)) + "\n]\n")
