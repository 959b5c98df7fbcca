"""Joint futures against what happened: the risk of plans, what a plan tells about others, and social behaviour.

The folder of the convention ``star`` holds the recordings of ETH/UCY; each is forecast by the model of its fold. Other
places are ``MODEL:FOLDER=FPS`` (``MODEL:FOLDER=`` for times): csv files (frame, pedestrian, x, y in metres), forecast
by a model that was not trained on them. Moments are spread evenly over the windows of a place (20 steps, of the
pedestrians present at all of them); nobody else is known to the models.

    python scenes.py risk STAR_FOLDER [MODEL:FOLDER=FPS ...]

prints the reliability of the risk that somebody comes within 0.5 m of a pedestrian who plays the robot: its true future
is the plan. Draws risk.svg. Gaussian constant velocity has a deviation that lasts and grows linearly, to the sigma at
4.8 s with the least mean Brier score on all other places.

    python scenes.py given STAR_FOLDER [MODEL:FOLDER=FPS ...]

prints how the errors of the others change when the true future of one pedestrian is given as a plan.

    python scenes.py social STAR_FOLDER

prints how often joint futures, single hypotheses and constant velocity slow down, keep the distance and turn aside,
where people did and where they did not. Draws social.svg: the moments with the median joint error of four kinds.
"""

import sys
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import ddl_forecast as ddl
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
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

    title: str
    model: str
    moments: list[ddl.Window]
    scene: bool  # one of the five scenes

    def forecasts(self) -> Iterator[tuple[ddl.Window, ddl.Forecast]]:
        """The moments whose pedestrians can all be forecast, with their joint forecasts."""
        forecaster = ddl.Forecaster(self.model)
        for moment in self.moments:
            forecast = forecaster.forecast(moment.past, joint=True)
            if forecast.valid.all():
                yield moment, forecast


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
    return Place(f"{name} (`{model}`)", model, [windows[index] for index in chosen], scene)


def truth(moment: ddl.Window) -> Floats:
    """(n, 13, 2) the present and the true future."""
    return np.concatenate([moment.past[:, -1:], moment.future], axis=1)


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
    """Plans of one place or several."""

    title: str
    moments: int
    scene: bool
    rows: Floats  # (plans, 5): happened, close at the start, risk, risk of a plan that nobody sees, Gaussian
    sigma: str = "-"


def measured(of: Place) -> Plans:
    """Its rows have the Gaussian probabilities of all sigmas."""
    rng = np.random.default_rng(0)
    rows, moments = [], 0
    for moment, forecast in of.forecasts():
        moments += 1
        paths = truth(moment)
        for ego in rng.permutation(len(paths))[:EGOS].tolist():
            others = np.arange(len(paths)) != ego
            close = nearest(paths[others], paths[ego]).min() < WITHIN
            already = np.linalg.norm(paths[others, 0] - paths[ego, 0], axis=1).min() < WITHIN
            plans = [np.column_stack([0.4 * TIMES, paths[ego]])]
            risks = [forecast.risk(plans, WITHIN, ego=ego, seen=seen).total[0] for seen in (True, False)]
            rows.append([close, already, *risks, *gaussian(moment.past[others], paths[ego])])
    return Plans(of.title, moments, of.scene, np.array(rows, dtype=float))


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
    more = "ECE | Brier | Gaussian: sigma | predicted | ECE | Brier | ratio of Brier"
    lines = [f"| {heads} | {more} |", "|---|" + "---:|" * 15]
    for one in parts:
        happened, _, seen, unseen, gauss = one.rows.T
        rng = np.random.default_rng(0)
        chance = np.mean([ece(seen, (rng.random(len(seen)) < seen).astype(float)) for _ in range(200)])
        briers = [((of - happened) ** 2).mean() for of in (seen, unseen, gauss)]
        of_plans = f"{one.title} | {one.moments} | {len(seen)} | {happened.mean():.3f} | {seen.mean():.3f}"
        known = f"{ece(seen, happened):.3f} | {chance:.3f} | {briers[0]:.4f}"
        hidden = f"{unseen.mean():.3f} | {ece(unseen, happened):.3f} | {briers[1]:.4f}"
        baseline = f"{one.sigma} | {gauss.mean():.3f} | {ece(gauss, happened):.3f} | {briers[2]:.4f}"
        lines.append(f"| {of_plans} | {known} | {hidden} | {baseline} | {briers[0] / briers[2]:.2f} |")
    return "\n".join(lines) + "\n"


def draw_risk(sums: Sequence[Plans], path: str) -> None:
    layout: Any = {"height_ratios": [4, 1], "layout": "constrained"}
    figure, (panel, counts) = plt.subplots(2, 1, figsize=(4.8, 5.4), sharex=True, **layout)
    panel.plot([0, 1], [0, 1], color="0.85", linewidth=1)
    for index, one in enumerate(sums):
        happened, _, seen, _, gauss = one.rows.T
        color, line = f"C{index}", ("-", "--")[index]
        known = (seen, color, f"{one.title}: ECE {ece(seen, happened):.3f}", 2)
        baseline = (gauss, "0.6", f"the same, Gaussian constant velocity: {ece(gauss, happened):.3f}", 1)
        for predicted, of_line, label, width in (known, baseline):
            which = bins(predicted)
            groups = [which == of for of in range(BINS) if np.count_nonzero(which == of) >= 20]
            points = np.array([(predicted[of].mean(), happened[of].mean()) for of in groups])
            panel.plot(*points.T, line, color=of_line, linewidth=width, marker=".", label=label, zorder=2 + width)
        at = np.arange(BINS) / BINS + 0.03 + 0.04 * index
        counts.bar(at, np.bincount(bins(seen), minlength=BINS), 0.035, color=color)
    panel.set(ylabel="share that happened", xlim=(0, 1), ylim=(0, 1))
    panel.set_title(f"Somebody comes within {WITHIN} m of a plan in 4.8 s")
    panel.legend(loc="upper left", frameon=False, fontsize=8)
    counts.set(xlabel="predicted probability", ylabel="plans", yscale="log")
    for axes in (panel, counts):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, metadata={"Date": None})


def risk(star: str, others: Sequence[str]) -> None:
    parts = [measured(of) for of in places(star, others, 2)]
    errors = [(one.rows[:, 4:] - one.rows[:, :1]) ** 2 for one in parts]
    briers = np.array([of.mean(axis=0) for of in errors])
    for index, one in enumerate(parts):
        best = int(np.delete(briers, index, axis=0).mean(axis=0).argmin())
        one.rows, one.sigma = one.rows[:, [0, 1, 2, 3, 4 + best]], f"{SIGMAS[best]:.2f}"
    sums = []
    for title, scene in (("five scenes", True), ("other places", False)):
        if some := [one for one in parts if one.scene == scene]:
            rows = np.concatenate([one.rows for one in some])
            sums.append(Plans(title, sum(one.moments for one in some), scene, rows))
    print(f"# Risk within {WITHIN} m in 4.8 s\n\n{table_of_risk([*parts, *sums])}")
    free = [replace(one, rows=one.rows[one.rows[:, 1] == 0]) for one in [*parts, *sums]]
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
    """Every second moment counts, if somebody has another one near, with one such ego."""
    heads = [f"{name} {of}" for name in ("near", "all") for of in ("minADE", "minFDE", "mean ADE", "JADE", "JFDE")]
    print("# Errors of others with the true future of one given, without it, and the change\n")
    print(f"| recording (model) | moments | near | all | {' | '.join(heads)} |\n|---|{'---:|' * 13}", flush=True)
    for of in places(star, others, 2):
        rng = np.random.default_rng(0)
        forecaster = ddl.Forecaster(of.model)
        of.moments = of.moments[::2]
        found: list[list[list[Floats]]] = [[[], []], [[], []]]  # near and all; without and with
        for moment, without in of.forecasts():
            now = moment.past[:, -1]
            apart = np.linalg.norm(now[:, None] - now, axis=-1) + 1e9 * np.eye(len(now))
            egos = np.flatnonzero(apart.min(axis=1) < NEAR)
            if len(egos) == 0:
                continue
            ego = int(rng.choice(egos))
            plan = np.column_stack([0.4 * TIMES, truth(moment)[ego]])
            told = forecaster.forecast(moment.past, joint=True, plan=plan, ego=ego)
            for kind, some in enumerate((apart[ego] < NEAR, np.arange(len(now)) != ego)):
                for which, forecast in enumerate((without, told)):
                    found[kind][which].append(errors_of(forecast, moment.future, some))
        cells, counts = [], []
        for errors in found:
            before, after = (np.concatenate(which, axis=1) for which in errors)
            counts.append(before.shape[1])
            means = zip(after.mean(axis=1), before.mean(axis=1), strict=True)
            cells += [f"{a:.3f}, {b:.3f}: {100 * (a / b - 1):+.1f} %" for a, b in means]
        print(f"| {of.title} | {len(found[0][0])} | {counts[0]} | {counts[1]} | {' | '.join(cells)} |", flush=True)


WALKS, CROWD = 0.5, 4  # m/s from which on somebody walks; pedestrians in a panel of the figure, at most
COMES, SLOWER = 1.2, 0.7  # metres from the way of somebody who slows down, to this share of the speed
CLOSE, ASIDE = 0.4, 0.3  # metres: distance that people keep; from constant velocity where they turn aside
KINDS = ("slowed down", "kept the distance", "kept the distance in the same future", "turned aside")
COLUMNS = ("likeliest joint", "weight", "any", "likeliest single", "weight", "any", "constant velocity")
PANELS = ("one alone", "a group", "a meeting", "following")


def speed(paths: Floats) -> Floats:
    """Mean speed along (..., t, 2) paths."""
    mean: Floats = np.linalg.norm(np.diff(paths, axis=-2), axis=-1).mean(axis=-1) / 0.4
    return mean


def companions(past: Floats) -> Flags:
    """(n, n) who walks with whom: on average within 2.2 m, and with a difference of velocity below 0.35 m/s."""
    velocity = (past[:, -1] - past[:, 0]) / 2.8
    apart = np.linalg.norm(past[:, None] - past, axis=-1).mean(axis=-1)
    together: Flags = (apart < 2.2) & (np.linalg.norm(velocity[:, None] - velocity, axis=-1) < 0.35)
    return together


def shares(did: Flags, weights: Floats) -> list[float]:
    return [float(did[weights.argmax()]), float((did * weights).sum()), float(did.any())]


def behaviours(moment: ddl.Window, joint: ddl.Forecast, single: ddl.Forecast) -> Iterator[tuple[str, list[float]]]:
    """Each kind with whether the pedestrian behaved so, and the numbers of COLUMNS."""
    line, true = constant_velocity(moment.past), truth(moment)
    ways = [np.insert(of.paths, 0, moment.past[:, None, -1], axis=2) for of in (joint, single)]  # (n, k, 13, 2)
    off, apart = nearest(line[:, None], true), np.linalg.norm(true[:, None, 0] - true[:, 0], axis=-1)
    observed, same = speed(moment.past), companions(moment.past)
    met = np.where(apart >= CLOSE, off, np.inf)
    for i in np.flatnonzero(observed >= WALKS):
        of_each = [(of[i], forecast.weights[i]) for of, forecast in zip(ways, (joint, single), strict=True)]

        def row(does: Any, forecast: Any = None) -> list[float]:
            numbers = [shares((forecast or does)(paths), weights) for paths, weights in of_each]
            return [float(does(true[i])), *numbers[0], *numbers[1], float((forecast or does)(line[i]))]

        if ((off[i] < COMES) & (apart[i] >= COMES) & ~same[i]).any():
            yield KINDS[0], row(lambda paths: speed(paths[..., :7, :]) < SLOWER * observed[i])
        j = int(met[i].argmin())
        if met[i, j] >= CLOSE:
            continue
        yield KINDS[1], row(lambda paths: nearest(paths, true[j]) >= CLOSE)
        kept = bool(nearest(true[i], true[j]) >= CLOSE)
        clear, pairs = nearest(ways[0][i], ways[0][j]) >= CLOSE, nearest(ways[1][i][:, None], ways[1][j]) >= CLOSE
        odds = single.weights[i][:, None] * single.weights[j]
        numbers = [*shares(clear, joint.weights[i]), *shares(pairs.ravel(), odds.ravel())]
        yield KINDS[2], [kept, *numbers, float(nearest(line[i], line[j]) >= CLOSE)]
        if kept:
            when = 1 + int(np.linalg.norm(line[i] - true[j], axis=1)[1:].argmin())
            step = line[i, 1] - line[i, 0]
            ahead = step / max(float(np.linalg.norm(step)), 1e-9)

            def aside(paths: Floats) -> Any:
                move = paths[..., when, :] - line[i, 0]
                return move[..., 1] * ahead[0] - move[..., 0] * ahead[1]

            side = aside(true[i])
            same_side = lambda paths: np.sign(side) * aside(paths) > ASIDE
            yield KINDS[3], row(lambda paths: abs(aside(paths)) > ASIDE, same_side if abs(side) > ASIDE else None)


def panel_of(moment: ddl.Window) -> str | None:
    """The kind of a moment that the figure may show."""
    past, paths = moment.past, truth(moment)
    if len(past) > CROWD or (speed(past) < WALKS).any():
        return None
    if len(past) == 1:
        return PANELS[0]
    same, heading = companions(past), past[:, -1] - past[:, 0]
    heading /= np.linalg.norm(heading, axis=1, keepdims=True)
    apart = past[None, :, -1] - past[:, None, -1]
    along = (apart * heading[:, None]).sum(axis=-1)
    beside = np.abs(apart[..., 1] * heading[:, None, 0] - apart[..., 0] * heading[:, None, 1])
    distance, cosine = np.linalg.norm(apart, axis=-1), heading @ heading.T
    if ((cosine < -0.5) & (distance > 2) & (nearest(paths[:, None], paths) < 2)).any():
        return PANELS[2]
    if ((cosine > 0.9) & (along > 1) & (along < 4) & (beside < 0.6)).any():
        return PANELS[3]
    return PANELS[1] if same.all() else None


def draw_panel(axes: Axes, moment: ddl.Window, joint: ddl.Forecast) -> None:
    """Turned so that the longest way lies along x."""
    likeliest = np.insert(joint.paths[:, 0], 0, moment.past[:, -1], axis=1)
    parts = [constant_velocity(moment.past), truth(moment), likeliest, moment.past]
    every = np.concatenate(parts, axis=1).reshape(-1, 2)
    turn = np.linalg.svd(every - every.mean(axis=0), full_matrices=False)[2].T
    turn[:, 1] *= np.sign(np.linalg.det(turn))
    for i in range(len(moment.past)):
        line, true, future, seen = ((part[i] - every.mean(axis=0)) @ turn for part in parts)
        axes.plot(*line.T, color="0.55", linewidth=0.7, label="constant velocity")
        axes.plot(*true.T, "o-", color="C1", linewidth=1.8, markersize=5, markevery=[-1], label="what happened, 4.8 s")
        axes.plot(*future.T, "*--", color="C0", linewidth=1.8, markersize=9, markevery=[-1], label="likeliest future")
        axes.plot(*seen.T, ".", color="#222222", markersize=4, label="observed, 3.2 s")
        axes.plot(*seen[-1], "o", color="#222222", markersize=4)
    left = float(((every - every.mean(axis=0)) @ turn)[:, 0].min())
    axes.plot([left, left + 2], [0.02, 0.02], color="#222222", linewidth=2, transform=axes.get_xaxis_transform())
    axes.text(left + 1, 0.05, "2 m", ha="center", size=8, transform=axes.get_xaxis_transform())
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.04, 0.2)
    axes.axis("off")


def draw_social(examples: dict[str, list[tuple[float, str, ddl.Window, ddl.Forecast]]], path: str) -> None:
    figure, grid = plt.subplots(2, 2, figsize=(9, 4.8), layout="constrained")
    for axes, kind in zip(grid.flat, PANELS, strict=True):
        found = sorted(examples[kind], key=lambda one: one[0])
        error, name, moment, joint = found[len(found) // 2]
        draw_panel(axes, moment, joint)
        title = f"{kind}: {name}, frame {moment.frame}\nbest joint future {error:.2f} m off, median of {len(found)}"
        axes.set_title(title, size=9)
    legend = [of[3::-1] for of in axes.get_legend_handles_labels()]
    figure.legend(*legend, loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, metadata={"Date": None})


def social(star: str) -> None:
    rows: dict[str, dict[str, list[list[float]]]] = {kind: {} for kind in KINDS}
    examples: dict[str, list[tuple[float, str, ddl.Window, ddl.Forecast]]] = {kind: [] for kind in PANELS}
    for of in places(star, [], 1):
        forecaster = ddl.Forecaster(of.model)
        for moment, joint in of.forecasts():
            for kind, numbers in behaviours(moment, joint, forecaster.forecast(moment.past)):
                rows[kind].setdefault(of.title, []).append(numbers)
            panel = panel_of(moment)
            if panel is not None:
                error = ddl.metrics.joint_ade(joint.paths, moment.future)
                examples[panel].append((error, of.model, moment, joint))
    for kind in KINDS:
        print(f"# {kind}\n\n| where they did | pedestrians | truth | {' | '.join(COLUMNS)} |\n|---|{'---:|' * 9}")
        parts = [(title, np.array(of_scene, dtype=float)) for title, of_scene in rows[kind].items()]
        every = np.concatenate([of_scene for _, of_scene in parts])
        for title, some in [*parts, ("all", every), ("all, where they did not", every)]:
            some = some[some[:, 0] == (0 if "not" in title else 1)]
            means = [f"{100 * mean:.0f} %" for mean in some.mean(axis=0)] if len(some) else ["-"] * 8
            print(f"| {title} | {len(some)} | {' | '.join(means)} |")
        print(flush=True)
    draw_social(examples, "social.svg")


if __name__ == "__main__":
    warnings.simplefilter("ignore", ddl.DoubtWarning)
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "scenes", "font.size": 9})
    match sys.argv[1:]:
        case ["risk", star, *others]:
            risk(star, others)
        case ["given", star, *others]:
            given(star, others)
        case ["social", star]:
            social(star)
        case _:
            sys.exit(__doc__)
