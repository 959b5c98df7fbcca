"""Joint futures against what happened: the risk of plans, what a plan tells about others, and social behaviour.

The folder of the convention ``star`` holds the recordings of ETH/UCY; each is forecast by the model of its fold. Other
places are ``MODEL:FOLDER=FPS`` (``MODEL:FOLDER=`` for times): csv files (frame, pedestrian, x, y in metres), forecast by
a model that was not trained on them. Moments are spread evenly over the windows of a place (20 steps, of the
pedestrians present at all of them); nobody else is known to the models.

    python scenes.py risk STAR_FOLDER [MODEL:FOLDER=FPS ...]

prints the reliability of the risk that somebody comes within 0.5 m of a pedestrian who plays the robot: its true future
is the plan. Draws risk.svg. Gaussian constant velocity has a deviation that lasts and grows linearly, to the sigma at
4.8 s with the least mean Brier score on all other places.

    python scenes.py given STAR_FOLDER [MODEL:FOLDER=FPS ...]

prints how the errors of the others change when the true future of one pedestrian is given as a plan.

    python scenes.py social STAR_FOLDER

prints how often people slow down, keep their distance and turn aside where they did, for joint futures, single
hypotheses and constant velocity; and how often where they did not. Draws social.svg: for four kinds of moments the one
with the median joint error.
"""

import sys
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ddl_forecast as ddl
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray
from regions import TESTED, Floats, recordings_of

Flags = NDArray[np.bool_]
MOST, FEW, PEDESTRIANS = 600, 300, 5000  # at most so many moments of a place; FEW where they have more pedestrians
EGOS = 4  # at most this many pedestrians of a moment play the robot
WITHIN = 0.5  # metres from a plan that count as close
BINS = 10
SIGMAS = np.array([0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.3, 1.7])  # of Gaussian constant velocity at 4.8 s, metres
NEAR = 3.0  # metres from the ego
TIMES = np.arange(13)  # steps of 0.4 s from the present on
# 128 deviations of equal probability, standard normal in the plane, on a sunflower.
_INDEX = np.arange(128)
_RADIUS, _ANGLE = np.sqrt(-2 * np.log((_INDEX + 0.5) / 128)), _INDEX * np.pi * (3 - np.sqrt(5))
DEVIATIONS = _RADIUS[:, None] * np.stack([np.cos(_ANGLE), np.sin(_ANGLE)], axis=1)


@dataclass
class Place:
    """Moments of one place, and the model that forecasts them."""

    name: str
    model: str
    moments: list[ddl.Window]
    scene: bool  # one of the five scenes

    def forecasts(self, **options: Any) -> Iterator[tuple[ddl.Window, ddl.Forecast]]:
        """The moments whose pedestrians can all be forecast, with their joint forecasts."""
        forecaster = ddl.Forecaster(self.model)
        for moment in self.moments:
            forecast = forecaster.forecast(moment.past, joint=True)
            if forecast.valid.all():
                yield moment, forecast

    @property
    def title(self) -> str:
        return f"{self.name} (`{self.model}`)"


def places(star: str, others: Sequence[str], least: int) -> Iterator[Place]:
    """The five scenes and the other places: moments with at least so many pedestrians."""
    for model in dict.fromkeys(TESTED.values()):
        files = [Path(star, f"{stem}.csv") for stem, of in TESTED.items() if of == model]
        yield place(model, model, [ddl.read(file, format="star-csv") for file in files], least, True)
    for other in others:
        model, folder = other.split(":")
        yield place(Path(folder.split("=")[0]).name, model, recordings_of(folder, model), least, False)


def place(name: str, model: str, recordings: Sequence[ddl.Recording], least: int, scene: bool) -> Place:
    windows = [window for of in recordings for window in ddl.windows(of) if len(window.past) >= least]
    size = np.mean([len(window.past) for window in windows])
    count = min(len(windows), MOST, max(FEW, int(PEDESTRIANS / size)))
    chosen = np.linspace(0, len(windows) - 1, count).round().astype(int)
    print(f"{name}: {len(chosen)} of {len(windows)} moments", file=sys.stderr, flush=True)
    return Place(name, model, [windows[index] for index in chosen], scene)


def truth(moment: ddl.Window) -> Floats:
    """(n, 13, 2) the present and the true future."""
    return np.concatenate([moment.past[:, -1:], moment.future], axis=1)


def plan_of(path: Floats) -> Floats:
    return np.column_stack([0.4 * TIMES, path])


def constant_velocity(past: Floats) -> Floats:
    """(n, 13, 2) with the mean velocity of the last three steps."""
    step = (past[:, -1] - past[:, -4]) / 3
    path: Floats = past[:, -1:] + step[:, None] * TIMES[:, None]
    return path


def nearest(one: Floats, other: Floats) -> Floats:
    """Least distance of two (..., 13, 2) paths, also between the steps."""
    apart = one - other
    start, move = apart[..., :-1, :], np.diff(apart, axis=-2)
    share = -(start * move).sum(axis=-1) / np.maximum((move**2).sum(axis=-1), 1e-12)
    least: Floats = np.linalg.norm(start + share.clip(0, 1)[..., None] * move, axis=-1).min(axis=-1)
    return least


def gaussian(past: Floats, plan: Floats) -> Floats:
    """(sigmas,) probability that somebody comes close to the plan, for Gaussian constant velocity."""
    mean = constant_velocity(past)
    off, most = nearest(mean, plan), np.linalg.norm(DEVIATIONS, axis=1).max()
    nobody = []
    for sigma in SIGMAS:
        some = mean[off < WITHIN + most * sigma]
        paths = some[:, None] + (sigma * TIMES / 12)[:, None] * DEVIATIONS[:, None]
        nobody.append(np.prod(1 - (nearest(paths, plan) < WITHIN).mean(axis=1)))
    return 1 - np.array(nobody)


@dataclass
class Plans:
    """Probabilities for the plans of one place or several, and what happened."""

    title: str
    moments: int
    scene: bool
    rows: Floats  # (plans, 4 + sigmas): happened, close at the start, risk, risk of an unseen plan, Gaussian ones
    sigma: Any = None  # index in SIGMAS
    chosen: Floats | None = None  # (plans,) Gaussian probabilities of this sigma

    def briers(self) -> Floats:
        """(sigmas,) Brier scores of Gaussian constant velocity."""
        scores: Floats = ((self.rows[:, 4:] - self.rows[:, :1]) ** 2).mean(axis=0)
        return scores

    def only(self, some: Flags) -> "Plans":
        assert self.chosen is not None
        return Plans(self.title, self.moments, self.scene, self.rows[some], self.sigma, self.chosen[some])


def measured(of: Place) -> Plans:
    rng = np.random.default_rng(0)
    rows = []
    moments = 0
    for moment, forecast in of.forecasts():
        paths = truth(moment)
        moments += 1
        for ego in rng.permutation(len(paths))[:EGOS].tolist():
            others = np.arange(len(paths)) != ego
            close = nearest(paths[others], paths[ego]).min() < WITHIN
            already = np.linalg.norm(paths[others, 0] - paths[ego, 0], axis=1).min() < WITHIN
            seen, unseen = (
                forecast.risk([plan_of(paths[ego])], WITHIN, ego=ego, seen=seen).total[0] for seen in (True, False)
            )
            rows.append([close, already, seen, unseen, *gaussian(moment.past[others], paths[ego])])
    return Plans(of.title, moments, of.scene, np.array(rows, dtype=float))


def together(title: str, parts: Sequence[Plans]) -> Plans:
    rows, chosen = np.concatenate([one.rows for one in parts]), np.concatenate([one.chosen for one in parts])
    return Plans(title, sum(one.moments for one in parts), parts[0].scene, rows, None, chosen)


def bins(predicted: Floats) -> NDArray[np.int64]:
    which: NDArray[np.int64] = (predicted * BINS).astype(np.int64).clip(0, BINS - 1)
    return which


def ece(predicted: Floats, happened: Floats) -> float:
    which = bins(predicted)
    off = [abs((predicted - happened)[which == of].sum()) for of in range(BINS)]
    return float(sum(off) / len(predicted))


def table_of_risk(parts: Sequence[Plans]) -> str:
    """``by chance``: the mean ECE of a forecast whose probabilities are right, with as many independent plans."""
    heads = "recording (model) | moments | plans | happened | predicted | ECE | by chance | Brier | unseen: predicted"
    gauss = "ECE | Brier | Gaussian: sigma | predicted | ECE | Brier | ratio of Brier"
    lines = [f"| {heads} | {gauss} |", "|---|" + "---:|" * 15]
    for one in parts:
        happened, _, seen, unseen = one.rows[:, :4].T
        assert one.chosen is not None
        rng = np.random.default_rng(0)
        chance = np.mean([ece(seen, (rng.random(len(seen)) < seen).astype(float)) for _ in range(200)])
        briers = [((of - happened) ** 2).mean() for of in (seen, unseen, one.chosen)]
        of_plans = f"{one.title} | {one.moments} | {len(seen)} | {happened.mean():.3f} | {seen.mean():.3f}"
        known = f"{ece(seen, happened):.3f} | {chance:.3f} | {briers[0]:.4f}"
        hidden = f"{unseen.mean():.3f} | {ece(unseen, happened):.3f} | {briers[1]:.4f}"
        sigma = "-" if one.sigma is None else f"{SIGMAS[one.sigma]:.2f}"
        baseline = f"{sigma} | {one.chosen.mean():.3f} | {ece(one.chosen, happened):.3f} | {briers[2]:.4f}"
        lines.append(f"| {of_plans} | {known} | {hidden} | {baseline} | {briers[0] / briers[2]:.2f} |")
    return "\n".join(lines) + "\n"


def style() -> None:
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "scenes", "font.size": 9})


def draw_risk(sums: Sequence[Plans], path: str) -> None:
    style()
    figure, (panel, counts) = plt.subplots(
        2, 1, figsize=(4.8, 5.4), sharex=True, height_ratios=[4, 1], layout="constrained"
    )
    panel.plot([0, 1], [0, 1], color="0.85", linewidth=1)
    for index, one in enumerate(sums):
        assert one.chosen is not None
        happened, color, line = one.rows[:, 0], f"C{index}", ("-", "--")[index]
        known = (one.rows[:, 2], color, f"{one.title}: ECE {ece(one.rows[:, 2], happened):.3f}", 2)
        baseline = (one.chosen, "0.6", f"the same, Gaussian constant velocity: {ece(one.chosen, happened):.3f}", 1)
        for predicted, of_line, label, width in (known, baseline):
            which = bins(predicted)
            groups = [which == of for of in range(BINS) if np.count_nonzero(which == of) >= 20]
            points = np.array([(predicted[of].mean(), happened[of].mean()) for of in groups])
            panel.plot(*points.T, line, color=of_line, linewidth=width, marker=".", label=label, zorder=2 + width)
        at = np.arange(BINS) / BINS + 0.03 + 0.04 * index
        counts.bar(at, np.bincount(bins(one.rows[:, 2]), minlength=BINS), 0.035, color=color, align="center")
    panel.set(ylabel="share that happened", xlim=(0, 1), ylim=(0, 1))
    panel.set_title(f"Somebody comes within {WITHIN} m of a plan in 4.8 s")
    panel.legend(loc="upper left", frameon=False, fontsize=8)
    counts.set(xlabel="predicted probability", ylabel="plans", yscale="log")
    for axes in (panel, counts):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, metadata={"Date": None})


def risk(star: str, others: Sequence[str]) -> None:
    parts = [measured(of) for of in places(star, others, 2)]
    for one in parts:
        one.sigma = int(np.mean([of.briers() for of in parts if of is not one], axis=0).argmin())
        one.chosen = one.rows[:, 4 + one.sigma]
    kinds = [("five scenes", [one for one in parts if one.scene]), ("other places", [of for of in parts if not of.scene])]
    sums = [together(title, some) for title, some in kinds if some]
    print(f"# Risk within {WITHIN} m in 4.8 s\n\n{table_of_risk([*parts, *sums])}")
    free = [one.only(one.rows[:, 1] == 0) for one in [*parts, *sums]]
    print(f"# Nobody was so close at the start\n\n{table_of_risk(free)}", flush=True)
    draw_risk(sums, "risk.svg")


def errors_of(forecast: ddl.Forecast, future: Floats, some: Flags) -> Floats:
    """(5, pedestrians) errors: minADE, minFDE, mean ADE over the futures, ADE and FDE of the best joint future."""
    off = np.linalg.norm(forecast.paths - future[:, None], axis=-1)[some]
    ade, fde = off.mean(axis=-1), off[..., -1]
    mean = (ade * forecast.weights[some]).sum(axis=1)
    joint = [np.full(len(ade), of.mean(axis=0).min()) for of in (ade, fde)]
    return np.stack([ade.min(axis=1), fde.min(axis=1), mean, *joint])


def given(star: str, others: Sequence[str]) -> None:
    """Each moment in which somebody has another one near counts with one such ego."""
    heads = [f"{name} {of}" for name in ("near", "all") for of in ("minADE", "minFDE", "mean ADE", "JADE", "JFDE")]
    print("# Errors of others with the true future of one given, without it, and the change\n")
    print(f"| recording (model) | moments | near | all | {' | '.join(heads)} |\n|---|{'---:|' * 13}", flush=True)
    for of in places(star, others, 2):
        rng = np.random.default_rng(0)
        forecaster = ddl.Forecaster(of.model)
        found: list[list[list[Floats]]] = [[[], []], [[], []]]  # near and all; without and with
        for moment, without in of.forecasts():
            now = moment.past[:, -1]
            apart = np.linalg.norm(now[:, None] - now, axis=-1) + 1e9 * np.eye(len(now))
            egos = np.flatnonzero(apart.min(axis=1) < NEAR)
            if len(egos) == 0:
                continue
            ego = int(rng.choice(egos))
            plan = plan_of(truth(moment)[ego])
            told = forecaster.forecast(moment.past, joint=True, plan=plan, ego=ego)
            for kind, some in enumerate((apart[ego] < NEAR, np.arange(len(now)) != ego)):
                for which, forecast in enumerate((without, told)):
                    found[kind][which].append(errors_of(forecast, moment.future, some))
        cells = []
        for kind in found:
            before, after = (np.concatenate(which, axis=1).mean(axis=1) for which in kind)
            cells += [f"{a:.3f}, {b:.3f}: {100 * (a / b - 1):+.1f} %" for a, b in zip(after, before, strict=True)]
        counts = [sum(one.shape[1] for one in kind[0]) for kind in found]
        print(f"| {of.title} | {len(found[0][0])} | {counts[0]} | {counts[1]} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore", ddl.DoubtWarning)
    match sys.argv[1:]:
        case ["risk", star, *others]:
            risk(star, others)
        case ["given", star, *others]:
            given(star, others)
        case _:
            sys.exit(__doc__)
