# Writes scores.json: made-up windows of several sizes with their forecasts, and every metric as numpy 2 computes it
# from its definition, one pedestrian after another. `python3 scores.py` in this folder.
import json
import math

import numpy as np

K, STEP, DEGREES, FLOOR, LEVELS = 3, 6, 3.0, 1e-4, (0.5, 0.9)
KINDS = ["standing", "straight", "turning-left", "turning-right", "slowing-down", "speeding-up"]
random = np.random.default_rng(3)
norm = lambda v: np.hypot(v[..., 0], v[..., 1])


def track(kind, start, heading):
    # Speeds in metres per step while observed and after, and the turn between them.
    before, after, turn = {
        "standing": (0.01, 0.02, 0.0),
        "straight": (0.45, 0.5, 0.1),
        "turning-left": (0.5, 0.45, 0.7),
        "turning-right": (0.4, 0.4, -0.9),
        "slowing-down": (0.6, 0.3, 0.2),
        "speeding-up": (0.2, 0.4, 0.1),
    }[kind]
    speeds = [before] * 7 + [after] * 12
    headings = [heading] * 7 + [heading + turn] * 12
    steps = [[s * math.cos(h), s * math.sin(h)] for s, h in zip(speeds, headings)]
    path = np.cumsum([start] + steps, axis=0) + 0.01 * random.normal(size=(20, 2))
    return path.round(2)


def scene(recording, first, kinds):
    # Pedestrians in upper case are in the window, the others only among all of its frames.
    centre, heading = random.normal(size=2) * 8 + [3, -5], random.uniform(0, 6)
    names = [next(k for k in KINDS if k == name.lower()) for name in kinds]
    tracks = [track(k, centre + random.normal(size=2) * 0.25, heading + 0.1 * random.normal()) for k in names]
    scored = [name.isupper() for name in kinds]
    n = sum(scored)
    ends = np.array([t for t, s in zip(tracks, scored) if s])[:, None, 8:]
    growth = np.linspace(0.2, 1, 12)[None, None, :, None]
    early, late = random.normal(size=(2, n, K, 1, 2)) * random.uniform(0.2, 2.2, size=(n, 1, 1, 1))
    paths = ends + (1 - growth) * early + growth * late + random.normal(size=(n, K, 12, 2)) * 0.05
    goals = paths[:, :, -1] + random.normal(size=(n, K, 2)) * 0.5
    return dict(
        recording=recording,
        start=first,
        step=STEP,
        ids=[int(i) for i in sorted(random.choice(90, len(kinds), replace=False))],
        scored=scored,
        tracks=[t.tolist() for t in tracks],
        paths=paths.round(2).reshape(-1, 2).tolist(),
        weights=random.dirichlet([3] * K, size=n).ravel().tolist(),
        goals=goals.round(2).reshape(-1, 2).tolist(),
        certified=[bool(c) for c in random.random(n * K) < 0.6],
        scales=random.uniform(0.1, 0.5, size=n * 12).round(3).tolist(),
        paces=[int(p) for p in random.integers(0, 3, size=n)],
        familiarity=random.uniform(0.01, 1, size=n).round(3).tolist(),
    )


def closest(a, b):
    apart, least = np.asarray(a) - b, math.inf
    for r, q in zip(apart[:-1], apart[1:]):
        d = q - r
        s = min(max(-(r @ d) / (d @ d), 0), 1) if d @ d > 0 else 0
        least = min(least, math.hypot(*(r + s * d)))
    return least


def hits(paths, near):
    return [any(j != i and closest(p, q) < near for j, q in enumerate(paths)) for i, p in enumerate(paths)]


def kind_of(t):
    a, b = t[7] - t[0], t[19] - t[7]
    if (norm(t - t[0]) < 1).all():
        return "standing"
    if norm(a) < 0.5:
        return "speeding-up"
    if norm(b) < 0.5:
        return "slowing-down"
    angle = math.degrees(np.angle(complex(*b) / complex(*a)))
    if abs(angle) >= 20:
        return "turning-left" if angle > 0 else "turning-right"
    ratio = (norm(b) / 4.8) / (norm(a) / 2.8)
    return "slowing-down" if ratio <= 0.7 else "speeding-up" if ratio >= 1.3 else "straight"


def raised(matrix):
    values, vectors = np.linalg.eigh(matrix)
    return vectors @ np.diag(np.maximum(values, FLOOR)) @ vectors.T


def spread_of(points, w, truth, scale):
    # -ln of the density at the truth, deviations of the truth from the mean, covariance.
    mean = w @ points
    covariance = (w[:, None] * (points - mean)).T @ (points - mean)
    off = points - truth
    if scale is None:
        bandwidth = raised(covariance / (1 - (w**2).sum()) * (w**2).sum() ** (1 / 3))
        exponents = np.exp([-0.5 * o @ np.linalg.solve(bandwidth, o) for o in off])
        density = w @ exponents / (2 * math.pi * math.sqrt(np.linalg.det(bandwidth)))
    else:
        densities = (1 + (off**2).sum(axis=1) / scale**2 / DEGREES) ** (-0.5 * (DEGREES + 2))
        density = w @ densities / (2 * math.pi * scale**2)
        covariance = covariance + np.eye(2) * scale**2 * DEGREES / (DEGREES - 2)
    covariance = raised(covariance)
    deviations = math.sqrt((truth - mean) @ np.linalg.solve(covariance, truth - mean))
    return -max(math.log(max(density, 1e-300)), -20), deviations, covariance


def discs(points, w, scale, quantile):
    left = quantile + np.log(w / w.max())
    return [(p, scale * math.sqrt(2 * q)) for p, q in zip(points, left) if q >= 0]


def radius_of(discs):
    # The area on a grid of 24 x 24 cells.
    low = np.min([c - r for c, r in discs], axis=0)
    high = np.max([c + r for c, r in discs], axis=0)
    x, y = [low[a] + (high[a] - low[a]) * (np.arange(24) + 0.5) / 24 for a in (0, 1)]
    x, y = np.meshgrid(x, y)
    inside = np.any([(x - c[0]) ** 2 + (y - c[1]) ** 2 <= r * r for c, r in discs], axis=0)
    return math.sqrt(inside.mean() * np.prod(high - low) / math.pi)


def rollout(start, path, goal):
    path = np.vstack([start, path])
    left, steps = norm(path - goal), np.diff(path, axis=0)
    turns = [
        abs(math.degrees(np.angle(complex(*s) / complex(*(goal - p)))))
        for s, p, phi in zip(steps, path, left)
        if phi > 1e-3 and norm(s) > 1e-3
    ]
    falls = all(b < a or max(a, b) <= 1e-3 for a, b in zip(left, left[1:]))
    return falls, left[-1], max(turns, default=0.0)


def pedestrians(s, quantiles, with_spread):
    tracks = np.array(s["tracks"])
    own = np.flatnonzero(s["scored"])
    n = len(own)
    paths = np.array(s["paths"]).reshape(n, K, 12, 2)
    goals, weights = np.array(s["goals"]).reshape(n, K, 2), np.array(s["weights"]).reshape(n, K)
    truth = tracks[own, 8:]
    ade = norm(paths - truth[:, None]).mean(axis=2)
    fde = norm(paths[:, :, -1] - truth[:, None, -1])
    between = norm(paths[:, :, None] - paths[:, None])
    central = [int(np.argmin(b.mean(axis=-1) @ w)) for b, w in zip(between, weights)]
    best = [int(np.argmin(e.mean(axis=0))) for e in (ade, fde)]
    shown = [paths[i, k] for i, k in enumerate(central)]
    futures = tracks[:, 8:]
    future_hits = {d: [hits(paths[:, k], d) for k in range(K)] for d in (0.4, 0.2)}
    true_hits = {d: hits(truth, d) for d in (0.4, 0.2)}
    all_hit, shown_hit = hits(futures, 0.4), hits(shown, 0.4)
    found = []
    for i in range(n):
        likely, near_goal = int(np.argmax(weights[i])), int(np.argmin(norm(goals[i] - truth[i, -1])))
        scales = np.array(s["scales"]).reshape(n, 12)[i] if with_spread else [None] * 12
        parts = [spread_of(paths[i, :, t], weights[i], truth[i, t], scales[t]) for t in range(12)]
        pairs = [between[i, a, b] for a in range(K) for b in range(a)]
        one = dict(
            min_ade=ade[i].min(),
            min_fde=fde[i].min(),
            fde_at_min_ade=fde[i][ade[i].argmin()],
            ade_at_min_fde=ade[i][fde[i].argmin()],
            expected_ade=weights[i] @ ade[i],
            expected_fde=weights[i] @ fde[i],
            most_likely_ade=ade[i][likely],
            most_likely_fde=fde[i][likely],
            medoid=[ade[i][central[i]], fde[i][central[i]]],
            miss_rate=fde[i].min() > 0.5,
            miss_rate_1m=fde[i].min() > 1,
            miss_rate_2m=fde[i].min() > 2,
            collision_rate=shown_hit[i],
            true_collision_rate=all_hit[own[i]],
            true_neighbour_collision_rate=any(
                closest(shown[i], futures[j]) < 0.4 for j in range(len(tracks)) if j != own[i]
            ),
            goal_fde=norm(goals[i] - truth[i, -1]).min(),
            kde_nll=np.mean([p[0] for p in parts]),
            amd=np.mean([p[1] for p in parts]),
            amv=np.mean([p[2] for p in parts], axis=0),
            diversity=np.mean(pairs),
            end_diversity=np.mean([p[-1] for p in pairs]),
            weight_log_loss=-math.log(weights[i][near_goal]),
            rollouts=[rollout(tracks[own[i]][7], paths[i, k], goals[i, k]) for k in range(K)],
            joint=[ade[i][best[0]], fde[i][best[1]]],
            kind=kind_of(tracks[own[i]]),
        )
        if with_spread:
            of_level = [
                [discs(paths[i, :, t], weights[i], scales[t], quantiles[s["paces"][i]][level][t]) for t in range(12)]
                for level in (0, 1)
            ]
            inside = lambda region, p: any(norm(p - c) <= r for c, r in region)
            one["coverage"] = [np.mean([inside(r, p) for r, p in zip(o, truth[i])]) for o in of_level]
            one["region_radius"] = [radius_of(o[-1]) for o in of_level]
            one["familiarity"] = s["familiarity"][i]
        found.append(one)
    share = lambda d: [
        np.mean([np.mean(h) for h in future_hits[d]]),
        np.mean(future_hits[d][best[0]]),
        np.mean(true_hits[d]),
    ]
    return found, [np.mean([p["joint"][e] for p in found]) for e in (0, 1)], [share(0.4), share(0.2)]


def scores(scenes, quantiles, with_spread):
    parts = [pedestrians(s, quantiles, with_spread) for s in scenes]
    every = [p for part in parts for p in part[0]]
    n = len(every)
    mean = lambda name: np.mean([p[name] for p in every], axis=0).tolist()
    rollouts = [r for p in every for r in p["rollouts"]]
    single = lambda errors: dict(
        ade=np.mean([e[0] for e in errors]), fde=np.mean([e[1] for e in errors]), worst_ade=max(e[0] for e in errors)
    )
    over_pedestrians = lambda values: np.sum([len(p[0]) * np.array(v) for p, v in zip(parts, values)], axis=0) / n
    shares = lambda numbers: dict(zip(("mean", "best", "truth"), np.asarray(numbers).tolist()))
    found = dict(pedestrians=n, windows=len(scenes), hypotheses=K)
    found |= {name: mean(name) for name in every[0] if name not in ("medoid", "amv", "rollouts", "joint", "kind")}
    if not with_spread:
        found |= dict(coverage=None, region_radius=None, familiarity=None)
    found |= dict(
        amv=np.linalg.eigvalsh(np.mean([p["amv"] for p in every], axis=0)).max(),
        joint_ade=mean("joint")[0],
        joint_fde=mean("joint")[1],
        likeliest=single([(p["most_likely_ade"], p["most_likely_fde"]) for p in every]),
        medoid=single([p["medoid"] for p in every]),
        stability=dict(
            rollouts=len(rollouts),
            decreasing=np.mean([r[0] for r in rollouts]),
            end_distance=np.mean([r[1] for r in rollouts]),
            largest_turn=np.mean([r[2] for r in rollouts]),
            reversing=np.mean([r[2] > 90 for r in rollouts]),
            certified=np.mean([c for s in scenes for c in s["certified"]]),
        ),
        joint=dict(
            ade_windows=np.mean([p[1][0] for p in parts]),
            fde_windows=np.mean([p[1][1] for p in parts]),
            collisions=shares(over_pedestrians([p[2][0] for p in parts])),
            close_collisions=shares(np.mean([p[2][1] for p in parts], axis=0)),
        ),
        categories=[
            dict(
                category=dict(motion=kind),
                pedestrians=len(some),
                min_ade=np.mean([p["min_ade"] for p in some]),
                min_fde=np.mean([p["min_fde"] for p in some]),
                joint_ade=np.mean([p["joint"][0] for p in some]),
                joint_fde=np.mean([p["joint"][1] for p in some]),
            )
            for kind in KINDS
            if (some := [p for p in every if p["kind"] == kind])
        ],
    )
    return found, parts


def blocks(scenes, parts, is_joint):
    sums = {}
    for s, (found, joint, _) in zip(scenes, parts):
        key = (s["recording"], s["start"] // (50 * STEP))
        errors = (
            len(found) * np.array(joint) if is_joint else sum(np.array([p["min_ade"], p["min_fde"]]) for p in found)
        )
        count, sum_so_far = sums.get(key, (0, np.zeros(2)))
        sums[key] = (count + len(found), sum_so_far + errors)
    names = ("recording", "block", "pedestrians", "min_ade", "min_fde")
    return [dict(zip(names, (*key, count, *errors.tolist()))) for key, (count, errors) in sorted(sums.items())]


def baselines(scenes):
    # ADE and FDE of constant velocity (last step, mean step), bounded constant acceleration, the true straight line.
    found = []
    for s in scenes:
        for t in np.array(s["tracks"])[s["scored"]]:
            steps, ahead = np.diff(t[:8], axis=0), np.arange(1, 13)[:, None]
            here, step, way, stands = t[7], steps[6], [], False
            for _ in range(12):
                step = step + steps[6] - steps[5]
                stands |= bool(step @ steps[6] < 0)
                step = step * 0 if stands else step * min(1, norm(steps).max() / max(norm(step), 1e-12))
                here = here + step
                way.append(here)
            lines = [t[7] + ahead * v for v in (steps[6], (t[7] - t[0]) / 7)]
            lines += [np.array(way), t[7] + ahead / 12 * (t[19] - t[7])]
            found.append([[norm(line - t[8:]).mean(), norm(line - t[8:])[-1]] for line in lines])
    return np.mean(found, axis=0).tolist()


scenes = [
    scene("b", 294, ["STRAIGHT", "straight", "TURNING-LEFT", "standing", "STANDING"]),
    scene("a", 1200, ["TURNING-RIGHT"]),
    scene("b", 0, ["slowing-down", "SLOWING-DOWN", "STRAIGHT"]),
    scene("b", 300, ["STRAIGHT", "SPEEDING-UP", "STRAIGHT", "TURNING-RIGHT", "STRAIGHT", "straight"]),
    scene("a", -6, ["STANDING", "SPEEDING-UP"]),
]
quantiles = (np.sort(random.uniform(0.3, 2.5, size=(3, 2, 12)), axis=1)).round(2).tolist()
expected, parts = scores(scenes, quantiles, True)
bare, _ = scores(scenes, quantiles, False)
# The scenes tell the mistakes apart.
for near in ("collisions", "close_collisions"):
    shares = expected["joint"][near]
    assert shares["mean"] != shares["best"] != shares["truth"] > 0, shares
assert len(expected["categories"]) == 6 and 0 < expected["stability"]["reversing"] < 1 and bare["kde_nll"] < 20
assert len({expected[n] for n in ("collision_rate", "true_collision_rate", "true_neighbour_collision_rate")}) == 3
errors = [round(e, 6) for name, e in expected.items() if name.endswith("ade") or name.endswith("fde")]
assert len(set(errors)) == len(errors) and expected["likeliest"] != expected["medoid"]
assert expected["miss_rate"] < 1
assert len({expected[n] for n in ("miss_rate", "miss_rate_1m", "miss_rate_2m")}) == 3, expected["miss_rate_1m"]
reference = dict(
    regions=dict(levels=LEVELS, quantiles=quantiles),
    scores=expected,
    bare={name: bare[name] for name in ("kde_nll", "amd", "amv", "coverage", "region_radius", "familiarity")},
    blocks=[blocks(scenes, parts, is_joint) for is_joint in (False, True)],
    baselines=baselines(scenes),
)
with open("scores.json", "w") as file:
    lines = [f'"{name}":{json.dumps(value)}' for name, value in reference.items()]
    every = ",\n".join(json.dumps(s) for s in scenes)
    file.write("{" + ",\n".join(lines) + f',\n"scenes":[\n{every}\n]}}\n')
