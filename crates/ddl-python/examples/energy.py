"""Constants of the energy of joint futures, learned on recordings.

    python energy.py MODEL:FOLDER=FPS ...

maximises the conditional likelihood of the true path of each pedestrian, given the true paths of the others, under the
hypotheses of a model that was not trained there, for several contact distances of crowds. It prints the conflict
energies, the strengths of walking together, and what each folder gains when it is left out. Then it maximises the
likelihood that people come close to the true path of another, given the risk of that plan, and prints how strongly
those who see it keep away. crates/ddl-scene/src/energy.json holds such constants; the folders were dut, citr,
edinburgh, juelich, thor and sdd, each forecast by the model ``hotel``, and for the second part also lyon, corner, sind,
hc, magni and navware by ``world``.
"""

import json
import sys
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import ddl_forecast as ddl
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import log_expit, logit, logsumexp, softmax

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
Features = tuple[Floats, ...]
NEAR, SCALE = 0.4, 0.25  # m
CROWDED = [0.15, 0.22, 0.3, 0.4]  # m: contact distances where all let others come near
CROWDING = [0.25, 0.75]  # shares of people around who do: NEAR until the first, CROWDED from the second on
DISTANCES, VELOCITIES = [0.0, 1.2, 2.2, 4.0], [0.0, 0.15, 0.35, 0.6]  # m, m/s
STEPS = [3, 7, 11]
REACH, PRIOR = 12.0, 1e-3  # m; weight of the squares of the constants
PEDESTRIANS = 5000
WITHIN = [0.3, 0.5, 1.0, 1.5]  # m
PLANS, EGOS = 1200, 4  # plans of a place, most of a moment
SHIPPED = json.loads((Path(__file__).parents[2] / "ddl-scene/src/energy.json").read_text())["avoidance"]
Moments = list[tuple[ddl.Window, ddl.Forecast, ddl.Forecast]]  # with the forecasts of each alone, and joint


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


@dataclass
class Company:
    """What the observation tells of the pedestrians of a window."""

    present: Floats  # (n, n) distances now, m
    kept: Floats  # (n, n) least distances
    bins: Integers  # (2, n, n) of DISTANCES and VELOCITIES
    together: Flags  # (n, n)
    crowding: Floats  # (n,) share of people around who let others come near

    @classmethod
    def of(cls, past: Floats) -> Self:
        velocity, apart = (past[:, -1] - past[:, 0]) / 2.8, np.linalg.norm(past[:, None] - past[None], axis=-1)
        differ, present = np.linalg.norm(velocity[:, None] - velocity[None], axis=-1), apart[..., -1]
        bins = [
            np.searchsorted(limits, value, side="right") - 1
            for limits, value in ((DISTANCES, apart.mean(-1)), (VELOCITIES, differ))
        ]
        alone = np.eye(len(past), dtype=bool)
        kept = apart.min(-1)
        near = np.where(alone, np.inf, kept).min(1) < 0.6
        around = present < 5
        crowding = ((around & near).sum(1) + 0.5) / (around.sum(1) + 2)
        return cls(present, kept, np.array(bins), (bins[0] < 3) & (bins[1] < 3) & ~alone, crowding)


def features(window: ddl.Window, forecast: ddl.Forecast, crowded: float) -> Features:
    """Logarithms (n, 20) of weights and of the density of the truth, and the features (n, 20, 19) of the energy."""
    n, k = forecast.weights.shape
    past, future, company = window.past, window.future, Company.of(window.past)
    now, truth, partners = past[:, -1], truth_of(window), company.together.sum(1)
    paths = np.concatenate([np.broadcast_to(now[:, None, None], (n, k, 1, 2)), forecast.paths], axis=2)
    assert forecast.spread is not None
    off = ((forecast.paths[:, :, STEPS] - future[:, None, STEPS]) ** 2).sum(-1) / forecast.spread[:, None, STEPS] ** 2
    density = -2.5 * np.log1p(off.mean(-1) / 3)
    energy = np.zeros((n, k, 19))
    for i in range(n):
        others = np.flatnonzero((company.present[i] < REACH) & (np.arange(n) != i))
        for j in others:
            distance, speed = company.bins[:, i, j]
            share = np.interp((company.crowding[i] + company.crowding[j]) / 2, CROWDING, [0, 1])
            near = max(min(NEAR + share * (crowded - NEAR), company.kept[i, j]), 0.1)
            half = hats(least_distance(paths[i], truth[j]) / near)
            if not company.together[i, j]:
                energy[i, :, :5] += half
                continue
            energy[i, :, 5:10] += half
            gap = np.linalg.norm((paths[i, :, -1] - now[i]) - (truth[j, -1] - now[j]), axis=-1)
            energy[i, :, 10 + 3 * distance + speed] += np.log1p((gap / SCALE) ** 2 / 3) / np.sqrt(partners[i])
    return np.log(np.maximum(forecast.weights, 1e-6)), density, energy


def truth_of(window: ddl.Window) -> Floats:
    """(n, 13, 2) the present and the true future."""
    return np.concatenate([window.past[:, -1:], window.future], axis=1)


def loss(theta: Floats, place: Features) -> tuple[float, Floats]:
    """Negative log-likelihood of the truths of a place, nats a pedestrian, and its gradient."""
    weights, density, energy = place
    prior = weights - energy @ theta
    value = -(logsumexp(prior + density, axis=1) - logsumexp(prior, axis=1)).mean()
    change = softmax(prior + density, axis=1) - softmax(prior, axis=1)
    return float(value), np.einsum("nk,nkf->f", change, energy) / len(weights)


def fit(places: list[Features]) -> Floats:
    def total(theta: Floats) -> tuple[float, Floats]:
        each = [loss(theta, place) for place in places]
        value = float(np.mean([one[0] for one in each])) + PRIOR * float(theta @ theta)
        return value, np.mean([one[1] for one in each], axis=0) + 2 * PRIOR * theta

    found: Any = minimize(total, np.full(19, 0.1), jac=True, method="L-BFGS-B", bounds=[(0, 10)] * 19)
    return np.asarray(found.x)


def joined(parts: Iterable[Features]) -> Features:
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


def moments_of(words: str) -> Moments:
    """Moments with some PEDESTRIANS."""
    model, place = words.split(":", 1)
    folder, fps = place.split("=")
    rate = float(fps) if fps else None
    windows = [
        w for file in sorted(Path(folder).iterdir()) for w in ddl.windows(ddl.read(file, format="table", fps=rate))
    ]
    step = max(1, round(sum(len(w.past) for w in windows) / PEDESTRIANS))
    forecaster = ddl.Forecaster(model)
    both = [(w, forecaster.forecast(w.past), forecaster.forecast(w.past, joint=True)) for w in windows[::step]]
    return [moment for moment in both if moment[1].valid.all()]


def answers(moments: Moments) -> Features:
    """Of people near true paths of others, for each distance of WITHIN: whether they came close, the logarithm of the
    odds if they do not see the plan, of companions if they move as far as it does, and four features: the distance's
    index, whether it is a companion, the logarithm of the present or kept distance, and crowding.
    """
    rng, rows = np.random.default_rng(0), []
    egos = [(at, ego) for at, (window, *_) in enumerate(moments) for ego in rng.permutation(len(window.past))[:EGOS]]
    for chosen in rng.permutation(len(egos))[:PLANS]:
        at, ego = egos[chosen]
        window, _, forecast = moments[at]
        truth, company = truth_of(window), Company.of(window.past)
        close = least_distance(truth, truth[ego])
        plan = [np.column_stack([0.4 * np.arange(13), truth[ego]])]
        for index, within in enumerate(WITHIN):
            told = company.together[ego]
            kept = np.log(company.kept[ego] / within).clip(-0.5, 1)
            strength, slope = SHIPPED["companions"]
            odds = logit(forecast.risk(plan, within, ego=ego, seen=False).pedestrians[0].clip(1e-6, 1 - 1e-6))
            seen = logit(forecast.risk(plan, within, ego=ego, seen=True).pedestrians[0].clip(1e-6, 1 - 1e-6))
            odds = np.where(told, seen + np.maximum(strength + slope * kept, 0), odds)
            of = np.where(told, kept, np.log(company.present[ego].clip(0.5, 10) / 2))
            some = (odds > logit(0.002)) & (company.present[ego] > within) & (np.arange(len(truth)) != ego)
            columns = [close < within, odds, np.full(len(truth), index), told, of, company.crowding]
            rows.append(tuple(np.asarray(column, dtype=float)[some] for column in columns))
    return joined(rows)


def avoidance(theta: Floats, place: Features) -> float:
    """Negative log-likelihood, nats an answer. ``theta``: shares at the other distances, of strangers, companions."""
    happened, odds, index, told, of, crowding = place
    share = np.array([theta[0], 1.0, *theta[1:3]])[index.astype(int)]
    stranger = share * (theta[3] + theta[4] * of - theta[5] * crowding)
    seen = odds - np.maximum(np.where(told > 0, theta[6] + theta[7] * of, stranger), 0)
    return float(-(happened * log_expit(seen) + (1 - happened) * log_expit(-seen)).mean())


def main() -> None:
    warnings.simplefilter("ignore")
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    moments = {words: moments_of(words) for words in sys.argv[1:]}
    for crowded in CROWDED:
        places = {
            words: joined(features(window, alone, crowded) for window, alone, _ in of) for words, of in moments.items()
        }
        theta = fit(list(places.values()))
        value = np.mean([loss(theta, place)[0] for place in places.values()])
        print(f"contact distance of crowds {crowded} m: {value:.4f} nats")
        print("conflict alone", theta[:5].round(2), "together", theta[5:10].round(2))
        print("strengths by distance and velocity\n", theta[10:].reshape(3, 3).round(2))
        for words, place in places.items():
            left = fit([other for name, other in places.items() if name != words] or [place])
            gain = loss(np.zeros(19), place)[0] - loss(left, place)[0]
            print(f"{words}: {len(place[0])} pedestrians, {gain:.3f} nats each when it is left out", flush=True)
    seen = [answers(of) for of in moments.values()]
    shipped = [
        *np.delete(SHIPPED["shares"], 1)[:2],
        SHIPPED["shares"][3],
        *SHIPPED["strangers"],
        *SHIPPED["companions"],
    ]
    for name, start in (("nobody keeps away", np.zeros(8)), ("shipped", np.array(shipped))):
        print(f"{name}: {np.mean([avoidance(start, place) for place in seen]):.4f} nats an answer")
    best: Any = minimize(lambda t: np.mean([avoidance(t, place) for place in seen]), shipped, method="Powell")
    print(f"shares, strangers, companions {best.x.round(2)}: {best.fun:.4f} nats an answer")


if __name__ == "__main__":
    main()
