# Writes risk.json: risks and clearances of scenes like those of src/fixture.rs by Monte Carlo, with numpy 2.4.6:
# 200,000 deviations of every pedestrian on every hypothesis. `python3 risk.py` in this folder; again after a change of
# src/energy.json.
import json

import numpy as np

DRAWS = 200_000
PLACES = 16  # looked at in each step
with open("../../src/energy.json") as file:
    ENERGY = json.load(file)
AVOIDANCE, TOGETHER = ENERGY["avoidance"], ENERGY["together"]


def distances(case, pedestrian, future, z):
    """Distance of each draw from the edge of the plan, `[12][PLACES + 1][DRAWS]`."""
    rows = np.asarray(case["plan"])
    scales = [case["deviation"], *(case["scales"][pedestrian] * t / 12 for t in range(1, 13))]
    steps = []
    for step in range(12):
        # The radius of a row holds from its time on; rows are at the ends of steps.
        radius = rows[np.searchsorted(rows[:, 0], 0.4 * (step + 0.5)) - 1, 3]
        places = []
        for t in np.linspace(step, step + 1, PLACES + 1):
            plan = np.array([np.interp(0.4 * t, rows[:, 0], rows[:, column]) for column in (1, 2)])
            at = np.asarray(case["starts"][pedestrian]) + 0.4 * t * np.asarray(case["velocities"][pedestrian][future])
            gap = at - plan + np.interp(t, range(13), scales) * z
            places.append(np.linalg.norm(gap, axis=1) - radius)
        steps.append(places)
    return np.array(steps)


def apart(case):
    """Distances `[n][n]` (m) of people who stood; from oneself very far."""
    starts = np.asarray(case["starts"])
    return np.linalg.norm(starts[:, None] - starts, axis=-1) + 1e9 * np.eye(len(starts))


def response(case, pedestrian, reach):
    """Factors of the futures, and of the odds to come close, of somebody who sees the plan."""
    gaps, rows = apart(case), np.asarray(case["plan"])
    ego = case["ego"]
    if ego is not None and gaps[ego, pedestrian] < TOGETHER["distances"][2]:
        ties = (gaps < TOGETHER["distances"][2]).sum(1)
        band = np.searchsorted(TOGETHER["distances"], gaps[ego, pedestrian], side="right")
        strength = TOGETHER["strengths"][band][0] / np.sqrt(max(ties[ego], ties[pedestrian]))
        plan = [np.interp(4.8, rows[:, 0], rows[:, column]) - rows[0, column] for column in (1, 2)]
        off = np.linalg.norm(4.8 * np.asarray(case["velocities"][pedestrian]) - plan, axis=1)
        base, slope = AVOIDANCE["companions"]
        ratio = np.log(gaps[ego, pedestrian] / max(reach, 0.1)).clip(-0.5, 1)
        return (1 + (off / TOGETHER["scale"]) ** 2 / 3) ** -strength, np.exp(-max(base + slope * ratio, 0))
    strength, of_present, of_crowding = AVOIDANCE["strangers"]
    present = np.linalg.norm(np.subtract(case["starts"][pedestrian], rows[0, 1:3])).clip(0.5, 10)
    around = (gaps[pedestrian] < 5) | (np.arange(len(gaps)) == pedestrian)
    crowding = ((gaps.min(1)[around] < 0.6).sum() + 0.5) / (around.sum() + 2)
    share = np.interp(reach, AVOIDANCE["within"], AVOIDANCE["shares"])
    exponent = share * (strength + of_present * np.log(present / 2) - of_crowding * crowding)
    return np.ones(len(case["weights"])), np.exp(-max(exponent, 0))


def scene(rng, size, deviation, ego):
    n, k = 4, 3
    weights = rng.dirichlet(np.ones(k))
    case = {
        "starts": rng.uniform(-size, size, (n, 2)).tolist(),
        "velocities": rng.uniform(-1.2, 1.2, (n, k, 2)).tolist(),
        "weights": weights.tolist(),
        "scales": rng.uniform(0.1, 1.0, n).tolist(),
        "deviation": deviation,
        "plan": [[time, *rng.uniform(-2, 2, 2), float(rng.uniform(0, 0.8))] for time in (0, 1.6, 4.8)],
        "within": float(rng.uniform(0.1, 0.5)),
        "ego": ego,
    }
    reach = case["within"] + max(row[3] for row in case["plan"] if row[0] < 4.8)
    # Of each pedestrian and future: probabilities to be close of those who are now, and of others.
    close, clearances, nearest = np.zeros((n, k, 2, 24)), np.zeros(n), np.full(DRAWS, np.inf)
    for i in range(n):
        follows, edges = rng.choice(k, DRAWS, p=weights), []
        for future in range(k):
            z = rng.standard_normal((DRAWS, 2)) * np.sqrt(3 / rng.chisquare(3, DRAWS))[:, None]
            gaps = distances(case, i, future, z)
            edges.append(np.maximum(gaps.min((0, 1)), 0))
            clearances[i] += weights[future] * edges[-1].mean()
            now = gaps[0, 0] <= case["within"]
            during = gaps.min(1) <= case["within"]
            both = np.concatenate([during, np.logical_or.accumulate(during)])
            close[i, future] = [(both & now).mean(1), (both & ~now).mean(1)]
        nearest = np.minimum(nearest, np.choose(follows, edges))
    results = {}
    for name in ("unseen", "seen"):
        probabilities, nobody = np.zeros(n), np.ones(24)
        for i in set(range(n)) - {ego}:
            factors, odds = (np.ones(k), 1.0) if name == "unseen" else response(case, i, reach)
            own = weights * factors / (weights @ factors)
            # The odds of who is not close now are multiplied by the factor.
            now, later = own @ close[i, :, 0, -1], own @ close[i, :, 1, -1]
            share = later / max(1 - now, 1e-300)
            of_futures = close[i, :, 0] + odds / (1 - share + share * odds) * close[i, :, 1]
            probabilities[i] = own @ of_futures[:, -1]
            nobody *= 1 - own @ of_futures
        results[name] = np.concatenate([probabilities, 1 - nobody])
    case |= {name: np.round(values, 4).tolist() for name, values in results.items()}
    return case | {"clearances": np.round(clearances, 4).tolist(), "nearest": round(nearest.mean(), 4)}


rng = np.random.default_rng(1)
settings = [(4, 0.0, None), (4, 0.0, 1), (2, 0.4, None), (2, 0.8, 0), (3, 0.2, 2), (1.5, 0.0, 3), (5, 1.0, None)]
with open("risk.json", "w") as file:
    file.write("[\n" + ",\n".join(json.dumps(scene(rng, *setting)) for setting in settings) + "\n]\n")
