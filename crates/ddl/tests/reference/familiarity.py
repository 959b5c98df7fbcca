# Writes familiarity.json: the statistics of drawn motions, and the familiarity of others, computed with numpy 2.
# `python3 familiarity.py` in this folder. The test in src/trust/familiarity.rs draws the same motions.
import json

import numpy as np

TIME_STEP, TRACKS = 0.5, 1234
state = 7


def draw():
    global state
    state = (state * 1103515245 + 12345) % 2**31
    return state / 2**31


def pair(scale):
    return np.array([scale * (draw() - 0.5), scale * (draw() - 0.5)])


def motion():
    velocity, change = pair(2), pair(0.2)
    return np.array([velocity * t + 0.5 * t * t * change + pair(0.03) for t in range(9)])


def length(v):
    return np.sqrt((np.asarray(v) ** 2).sum(axis=-1))


def features(track):
    steps = np.diff(track, axis=0)
    speeds = length(steps) / TIME_STEP
    changes = length(np.diff(steps, axis=0))
    relative = lambda a, b: np.log((a + 0.2) / (b + 0.2))
    halves = length(track[4] - track[0]) / (4 * TIME_STEP), length(track[7] - track[3]) / (4 * TIME_STEP)
    straight = length(track[7] - track[0]) / (7 * TIME_STEP) / (speeds.mean() + 0.1)
    last = relative(speeds[-1], speeds.mean())
    return [np.log(speeds.mean() + 0.1), np.log(changes.mean() + 0.005), last, relative(*halves[::-1]), straight]


tracks = [motion()[:8] for _ in range(TRACKS)]
all_features = np.array([features(track) for track in tracks])
is_apart = np.arange(TRACKS) // 100 % 5 == 4
learned, apart = all_features[~is_apart], all_features[is_apart]
mean = learned.mean(axis=0)
precision = np.linalg.inv(np.cov(learned.T, bias=True) + 1e-6 * np.eye(5))
far = lambda x: float(np.sqrt((x - mean) @ precision @ (x - mean)))
ordered = sorted(far(x) for x in apart)
distances = [ordered[part * (len(ordered) - 1) // 100] for part in range(101)]
speeds = sorted(np.exp(all_features[:, 0]) - 0.1)
fastest = speeds[(TRACKS - 1) * 999 // 1000]


def familiarity(track):
    x = np.array(features(track))
    distance = far(x)
    if distance >= distances[-1]:
        share = 0.01 * np.exp(distances[-1] - distance)
    else:
        below = np.interp(distance, distances, np.arange(101) / 100)
        share = (1 - below) * 0.99 + 0.01
    faster = max(np.exp(x[0]) - 0.1 - fastest, 0)
    return min(max(share * np.exp(-faster), 1e-9), 1)


probes = [motion()[:8] for _ in range(8)]
along = lambda speed: np.array([[0.48 * speed * t + 0.01 * (t % 3), -0.14 * speed * t] for t in range(8)])
probes += [np.zeros((8, 2)) + [3, -4], along(fastest + 0.3), along(fastest + 2), along(0.02)]
jump = along(1.0)
jump[5:, 1] += 3
probes.append(jump)
found = [float(familiarity(p)) for p in probes]
print(found, max(distances), fastest)
assert 0.5 > sorted(found)[4] and max(found) > 0.8 and sum(f < 0.01 for f in found) >= 2
motions = dict(mean=mean.tolist(), precision=precision.tolist(), distances=distances, fastest=float(fastest))
with open("familiarity.json", "w") as file:
    json.dump(dict(motions=motions, probes=[p.tolist() for p in probes], familiarity=found), file)
