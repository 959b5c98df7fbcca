# Writes adaptive.json: what `AdaptiveRegions` learns from a stream of forecasts, with Python 3.11 alone. Written from
# the words of `src/region.rs` and `src/region/`. `python3 adaptive.py` in this folder. The stream is made as in
# `adaptive.rs`.
import json
import math

STEP, PACES, LEVELS, HORIZON = 3, 3, [0.25, 0.5, 0.8125], 12


class Draws:
    def __init__(self):
        self.state = 7

    def __call__(self):
        self.state = (self.state * 1_103_515_245 + 12_345) % (1 << 31)
        return self.state / (1 << 31)


def start_quantile(pace, level, t):
    """The split-conformal quantile of 99 scores."""
    rank = math.ceil(level * 100)
    return rank / (40 + 10 * pace) * (1 + 0.05 * t)


def stream():
    """Frame, and of each pedestrian: id, pace, last two positions, hypotheses, weights, scales, age and unseen."""
    draw, frame = Draws(), 100
    for at in range(240):
        later = [1, 2, 3, 3, 3, 3, 4, 5][int(8 * draw())]
        frame += later if at != 180 else 0
        if at in (60, 130):
            frame += 80 if at == 60 else -400
        people = []
        for i in range(14):
            u = [draw() for _ in range(8)]
            # Most are seen; the id is another person's every 40 windows.
            if u[0] < 0.1:
                continue
            pace = 2 if i >= 4 else i % 2
            way = [0.05 + 0.02 * i, 0.2 - 0.03 * i]
            place = lambda f: [3 * i + way[0] * f + 0.2 * math.sin(f), way[1] * f + 0.3 * math.cos(0.7 * f + i)]
            last, before = place(frame), place(frame - STEP)
            weights = [[0.7, 0.2, 0.1], [0.45, 0.55, 0.0] if at % 5 else [0.0, 0.3, 0.7], [0.15, 0.25, 0.6]][pace]
            size = [9.0, 0.4, 0.0004 if at < 120 else 1.2][pace]
            offs = [[0.01 * u[1], 0.02 * u[2]], [-0.1 - 0.05 * u[3], 0.07], [0.08, 0.1 * u[4]]]
            paths = [
                [[last[a] + (way[a] + off[a]) * STEP * t for a in (0, 1)] for t in range(1, HORIZON + 1)]
                for off in offs
            ]
            scales = [size * (1 + 0.1 * t) for t in range(HORIZON)]
            young = 1 + (at - 5) % 40 if i == 5 and (at - 5) % 40 < 6 and at > 40 else 0
            people.append(
                {
                    "id": i,
                    "pace": pace,
                    "seen": [before, last],
                    "paths": paths,
                    "weights": weights,
                    "scales": scales,
                    "age": 0.1 if u[5] < 0.1 else 0,
                    "unseen": 7 - young if young else 0,
                }
            )
        yield frame, people


class Adaptive:
    def __init__(self):
        self.shifts = {(p, a, t): 0.0 for p in range(PACES) for a in range(3) for t in range(HORIZON)}
        self.sums = {(p, t): 0.0 for p in range(PACES) for t in range(HORIZON)}
        self.log_powers = [0.0] * PACES
        self.pending = []
        self.table = self.shifted()

    def shifted(self):
        table = {}
        for p in range(PACES):
            for t in range(HORIZON):
                column = [
                    max(start_quantile(p, level, t), 1e-3) * math.exp(self.shifts[p, a, t])
                    for a, level in enumerate(LEVELS)
                ]
                table.update({(p, a, t): q for a, q in enumerate(sorted(column))})
        return table

    def adapt(self, now, people):
        if self.pending and self.pending[-1]["frame"] >= now:
            self.pending = []
        for one in people:
            if one["unseen"]:
                until = now - (7 - (one["unseen"] - 1)) * STEP
                for old in self.pending:
                    if old["frame"] <= until:
                        old["people"].pop(one["id"], None)
        previous = self.pending[-1]["frame"] if self.pending else None
        share = min((now - previous) / STEP, 1) if self.pending else 1
        here = {one["id"]: one for one in people if one["age"] == 0}
        learned, ended = [], []
        for old in self.pending:
            steps, back = divmod(now - old["frame"], STEP)
            if not 1 <= steps <= HORIZON or (back and previous >= now - back):
                continue
            truths = []
            for who, one in old["people"].items():
                if who in here:
                    before, last = here[who]["seen"]
                    truths.append((one, [last[a] + (before[a] - last[a]) * back / STEP for a in (0, 1)]))
            if truths:
                learned.append((steps - 1, old["table"], truths))
            if now - old["frame"] >= HORIZON * STEP and steps == HORIZON:
                ended += truths
        for t, table, truths in learned:
            moves = []
            for p in range(PACES):
                scores = [score(one, t, truth) for one, truth in truths if one["pace"] == p]
                w = share * min(math.sqrt(len(scores)), 3)
                missed = [sum(s > table[p, a, t] for s in scores) / max(len(scores), 1) for a in range(3)]
                moves.append((w, [0.06 * w * (missed[a] - (1 - level)) for a, level in enumerate(LEVELS)]))
            for p in range(PACES):
                youth = max(0, 1 - self.sums[p, t] / 30)
                for a in range(3):
                    total = sum(moves[o][1][a] * (1 if o == p else youth) for o in range(PACES))
                    bound = math.log(64)
                    self.shifts[p, a, t] = min(max(self.shifts[p, a, t] + total, -bound), bound)
                self.sums[p, t] += moves[p][0]
        for p in range(PACES):
            own = [gradient(one, truth) for one, truth in ended if one["pace"] == p]
            if own:
                rise = 0.01 * share * min(math.sqrt(len(own)), 3) * sum(own) / len(own)
                self.log_powers[p] = min(max(self.log_powers[p] + rise, -1.5), 1)
        self.table = self.shifted()
        raised = {}
        for one in people:
            weights = [w ** math.exp(self.log_powers[one["pace"]]) if w else 0.0 for w in one["weights"]]
            raised[one["id"]] = {**one, "weights": [w / sum(weights) for w in weights]}
        self.pending = [old for old in self.pending if now - old["frame"] < HORIZON * STEP]
        self.pending.append({"frame": now, "people": dict(raised), "table": self.table})
        return list(raised.values())

    def radius(self, one, k, t):
        """Of the level 0.6, between 0.5 and 0.8125."""
        low, high = self.table[one["pace"], 1, t], self.table[one["pace"], 2, t]
        quantile = low + (high - low) * (0.6 - 0.5) / (0.8125 - 0.5)
        share = one["weights"][k] / max(one["weights"])
        left = quantile + math.log(share) if share else -1
        return one["scales"][t] * math.sqrt(2 * left) if left >= 0 else 0.0


def score(one, t, truth):
    heaviest = max(one["weights"])
    scores = []
    for path, weight in zip(one["paths"], one["weights"]):
        if weight:
            off = math.dist(path[t], truth) / one["scales"][t]
            scores.append(off**2 / 2 - math.log(weight / heaviest))
    return min(scores)


def gradient(one, end):
    nearest = min(range(3), key=lambda k: math.dist(one["paths"][k][-1], end))
    log = [math.log(w) if w else math.log(2.0**-1022) for w in one["weights"]]
    return max(log[nearest] - sum(w * x for w, x in zip(one["weights"], log)), -10)


adaptive, rows = Adaptive(), []
for frame, people in stream():
    adapted = adaptive.adapt(frame, people)
    weights = [w for one in adapted for w in one["weights"]]
    radii = [adaptive.radius(one, k, t) for one in adapted for k in range(3) for t in range(HORIZON)]
    row = [sum(n * x for n, x in enumerate(xs, 1)) for xs in (weights, radii)]
    for p in range(PACES):
        quantiles = [adaptive.table[p, a, t] for a in range(3) for t in range(HORIZON)]
        row.append(sum(n * q for n, q in enumerate(quantiles, 1)))
    rows.append([frame] + [float(f"{x:.12g}") for x in row])
print(adaptive.log_powers, min(adaptive.shifts.values()), max(adaptive.shifts.values()), adaptive.sums)
with open("adaptive.json", "w") as file:
    file.write("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")
