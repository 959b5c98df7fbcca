"""Constants of the energy of joint futures, learned on recordings.

    python energy.py MODEL:FOLDER=FPS ...

maximises the conditional likelihood of the true path of each pedestrian, given the true paths of the others, under the
hypotheses of a model that was not trained there. It prints the conflict energies, the strengths of walking together,
and what each folder gains when it is left out. crates/ddl-scene/src/energy.json holds such constants; the folders were
dut, citr, edinburgh, juelich, thor and sdd, each forecast by the model ``hotel``.
"""

import sys
import warnings
from pathlib import Path
from typing import Any

import ddl_forecast as ddl
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import logsumexp, softmax

Floats = NDArray[np.float64]
NEAR, SCALE = 0.4, 0.25  # m
DISTANCES, VELOCITIES = [0.0, 1.2, 2.2, 4.0], [0.0, 0.15, 0.35, 0.6]  # m, m/s
STEPS = [3, 7, 11]
REACH, PRIOR = 12.0, 1e-3  # m; weight of the squares of the constants
PEDESTRIANS = 5000


def least_distance(a: Floats, b: Floats) -> Floats:
    """Least distance of paths (..., 13, 2) that are straight between the steps."""
    apart = a - b
    start, move = apart[..., :-1, :], np.diff(apart, axis=-2)
    share = np.clip(-(start * move).sum(-1) / np.maximum((move**2).sum(-1), 1e-12), 0, 1)
    least: Floats = np.linalg.norm(start + share[..., None] * move, axis=-1).min(-1)
    return least


def hats(x: Floats) -> Floats:
    """The share (..., 5) of the knots 0, 1/2 ... 2 in a piecewise linear function that is 0 from 5/2 on."""
    return np.stack([np.clip(1 - np.abs(2 * x - knot), 0, 1) for knot in range(5)], axis=-1)


def features(forecast: ddl.Forecast, past: Floats, future: Floats) -> tuple[Floats, Floats, Floats]:
    """Logarithms (n, 20) of weights and of the density of the truth, and the features (n, 20, 19) of the energy."""
    n, k = forecast.weights.shape
    now, velocity = past[:, -1], (past[:, -1] - past[:, 0]) / 2.8
    truth = np.concatenate([now[:, None], future], axis=1)
    paths = np.concatenate([np.broadcast_to(now[:, None, None], (n, k, 1, 2)), forecast.paths], axis=2)
    assert forecast.spread is not None
    off = ((forecast.paths[:, :, STEPS] - future[:, None, STEPS]) ** 2).sum(-1) / forecast.spread[:, None, STEPS] ** 2
    density = -2.5 * np.log1p(off.mean(-1) / 3)
    energy = np.zeros((n, k, 19))
    apart = np.linalg.norm(past[:, None] - past[None], axis=-1).mean(-1)
    differ = np.linalg.norm(velocity[:, None] - velocity[None], axis=-1)
    present = np.linalg.norm(now[:, None] - now[None], axis=-1)
    for i in range(n):
        others = np.flatnonzero((present[i] < REACH) & (np.arange(n) != i))
        bins = [
            np.searchsorted(limits, value[i, others], side="right") - 1
            for limits, value in ((DISTANCES, apart), (VELOCITIES, differ))
        ]
        together = (bins[0] < 3) & (bins[1] < 3)
        for j, distance, speed, joined in zip(others, *bins, together, strict=True):
            near = np.clip(min(NEAR, present[i, j]), 0.1, None)
            half = hats(least_distance(paths[i], truth[j]) / near)
            if not joined:
                energy[i, :, :5] += half
                continue
            energy[i, :, 5:10] += half
            gap = np.linalg.norm((paths[i, :, -1] - now[i]) - (truth[j, -1] - now[j]), axis=-1)
            energy[i, :, 10 + 3 * distance + speed] += np.log1p((gap / SCALE) ** 2 / 3) / np.sqrt(together.sum())
    return np.log(np.maximum(forecast.weights, 1e-6)), density, energy


def loss(theta: Floats, place: tuple[Floats, Floats, Floats]) -> tuple[float, Floats]:
    """Negative log-likelihood of the truths of a place, nats a pedestrian, and its gradient."""
    weights, density, energy = place
    prior = weights - energy @ theta
    value = -(logsumexp(prior + density, axis=1) - logsumexp(prior, axis=1)).mean()
    change = softmax(prior + density, axis=1) - softmax(prior, axis=1)
    return float(value), np.einsum("nk,nkf->f", change, energy) / len(weights)


def fit(places: list[tuple[Floats, Floats, Floats]]) -> Floats:
    def total(theta: Floats) -> tuple[float, Floats]:
        each = [loss(theta, place) for place in places]
        value = float(np.mean([one[0] for one in each])) + PRIOR * float(theta @ theta)
        return value, np.mean([one[1] for one in each], axis=0) + 2 * PRIOR * theta

    found: Any = minimize(total, np.full(19, 0.1), jac=True, method="L-BFGS-B", bounds=[(0, 10)] * 19)
    return np.asarray(found.x)


def place_of(words: str) -> tuple[Floats, Floats, Floats]:
    model, place = words.split(":", 1)
    folder, fps = place.split("=")
    rate = float(fps) if fps else None
    windows = [
        w for file in sorted(Path(folder).iterdir()) for w in ddl.windows(ddl.read(file, format="table", fps=rate))
    ]
    step = max(1, round(sum(len(w.past) for w in windows) / PEDESTRIANS))
    forecaster, parts = ddl.Forecaster(model), []
    for window in windows[::step]:
        parts.append(features(forecaster.forecast(window.past), window.past, window.future))
    weights, density, energy = (np.concatenate(column) for column in zip(*parts, strict=True))
    return weights, density, energy


def main() -> None:
    warnings.simplefilter("ignore")
    places = {words: place_of(words) for words in sys.argv[1:]}
    if not places:
        sys.exit(__doc__)
    theta = fit(list(places.values()))
    print("conflict alone", theta[:5].round(2), "together", theta[5:10].round(2))
    print("strengths by distance and velocity\n", theta[10:].reshape(3, 3).round(2))
    for words, place in places.items():
        left = fit([other for name, other in places.items() if name != words] or [place])
        gain = loss(np.zeros(19), place)[0] - loss(left, place)[0]
        print(f"{words}: {len(place[0])} pedestrians, {gain:.3f} nats each when it is left out")


if __name__ == "__main__":
    main()
