"""Regions of the built-in models: their coverage over the time of recordings, and their calibration.

    python regions.py measure STAR_FOLDER [MODEL:FOLDER=FPS ...]

prints the tables of docs/regions.md, and draws the curves of its figure as regions.svg. The folder of the convention
``star`` holds the recordings of ETH/UCY; each is forecast by the model of its fold. The other folders hold csv files
(frame, pedestrian, x, y in metres), forecast by a model that was not trained on them.

    python regions.py calibrate MODEL:FOLDER=FPS ...

prints for each folder, forecast by a model that was not trained on it, the coverage of regions that were calibrated on
the other folders, and writes the table of all folders to crates/ddl/src/trust/calibration.json.

    python regions.py wholes MODEL:FOLDER=FPS ...

writes there by which factors the regions of whole paths and of everybody at once are larger than those of that table.
"""

import json
import re
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
from numpy.typing import NDArray

Floats = NDArray[np.float64]
#: Recordings of the convention ``star`` that a fold tests on, and its model.
TESTED = {"eth": "eth", "hotel": "hotel", "zara01": "zara1", "zara02": "zara2"}
TESTED |= {"students001": "univ", "students003": "univ"}
LEVELS = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
HALF, MOST = 4, 8  # the levels that have columns in the table
CALIBRATED = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99]
STEP = 0.4 / 60  # minutes
SLIDING, APART = 1.0, 1.0 / 12.0  # interval over which a share is computed, and its step (minutes)
SHORTEST, FEWEST = 0.8, 1000  # minutes and forecasts of a pedestrian, below which a recording is left out
PEDESTRIANS = 2500  # about this many pedestrian-windows of a folder calibrate
LEAST = 100  # pedestrian-windows of a pace, below which a folder does not count for it
PACES = ("standing", "slow", "walking")
KINDS = ("fixed", "adaptive")


def recordings_of(place: str, model: str) -> list[ddl.Recording]:
    """The recordings of ``FOLDER=FPS`` (times: ``FOLDER=``), by name; none that the model was trained on."""
    folder, fps = place.split("=")
    rate = float(fps) if fps else None
    recordings = [ddl.read(path, format="table", fps=rate) for path in sorted(Path(folder).iterdir())]
    forecaster = ddl.Forecaster(model)
    known = [recording.name for recording in recordings if forecaster.was_trained_on(recording)]
    if known:
        sys.exit(f"{model} was trained on {', '.join(known)}: its regions hold too much there")
    return recordings


@dataclass
class Coverage:
    """Coverage of the regions of one recording, one row for each frame with a forecast."""

    name: str
    model: str
    minutes: Floats
    people: Floats
    seen: Floats  # positions at which a forecast pedestrian was observed
    held: Floats  # (frames, 2, levels) of these inside the fixed and the adaptive regions
    radii: Floats  # (frames, 2, 2) sums over pedestrians for the levels HALF and MOST, metres
    of_paces: Floats  # (frames, 3, 5) positions seen, and of these inside the regions of HALF and MOST, of both kinds
    wholes: (
        Floats  # (frames, 2, 3, 4) of paths, scenes, and scenes without those who left: how many were judged, inside
    )
    # the regions of HALF and of MOST, and the sum over pedestrians of the radii for MOST (metres)

    @property
    def later(self) -> slice:
        """The frames after the first quarter."""
        return slice(int(np.searchsorted(self.minutes, 0.25 * self.minutes[-1])), None)

    def share(self, kind: int, level: int, frames: slice = slice(None)) -> float:
        return float(self.held[frames, kind, level].sum() / self.seen[frames].sum())

    def radius(self, kind: int, which: int) -> float:
        return float(self.radii[self.later, kind, which].sum() / self.people[self.later].sum())

    def sliding(self, kind: int) -> Floats:
        """(points, 2): time (minutes), and the share inside the regions of 90 % in the minute before."""
        points = []
        for moment in range(int(SLIDING / 3 / APART), int(self.minutes[-1] / APART) + 1):
            now = moment * APART
            start, end = np.searchsorted(self.minutes, [now - SLIDING, now], side="right")
            if self.seen[start:end].sum() > 0:
                points.append((now, self.share(kind, MOST, slice(start, end))))
        return np.array(points)


def inside(forecast: ddl.Forecast, radii: Floats, ahead: Floats) -> NDArray[np.bool_]:
    """(n, 12) whether the later positions (n, 12, 2), NaN where unobserved, are inside the regions of these radii."""
    off = np.linalg.norm(ahead[:, None] - forecast.paths, axis=-1)
    held: NDArray[np.bool_] = (off <= radii).any(axis=1)
    return held


def wholes_of(forecast: ddl.Forecast, ahead: Floats) -> list[list[float]]:
    """The rows of ``Coverage.wholes`` for one frame and kind."""
    unseen = np.isnan(ahead[..., 0])
    known, throughout = ~unseen.all(axis=1), ~unseen.any(axis=1)
    held, radius = {}, {}
    for of in ("path", "scene"):
        of_levels = [forecast.regions(LEVELS[level], of=of) for level in (HALF, MOST)]
        held[of] = [(inside(forecast, radii, ahead) | unseen).all(axis=1) for radii in of_levels]
        radius[of] = sum(map(equivalent_radius, forecast.paths[:, :, -1], of_levels[1][:, :, -1]))
    paths = [throughout.sum(), *((one & throughout).sum() for one in held["path"]), radius["path"]]
    groups = [[some.any(), *(some.any() and one[some].all() for one in held["scene"])] for some in (known, throughout)]
    return [paths, *([*group, radius["scene"]] for group in groups)]


def equivalent_radius(centres: Floats, radii: Floats, cells: int = 24) -> float:
    """Radius of a disc with the area of the discs together, measured on a grid."""
    some = ~np.isnan(radii)
    centres, radii = centres[some], radii[some]
    low, high = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
    shares = (np.arange(cells) + 0.5) / cells
    grid = np.stack(np.meshgrid(*(low + shares[:, None] * (high - low)).T), axis=-1)
    covered = (((grid[None] - centres[:, None, None]) ** 2).sum(axis=-1) <= (radii**2)[:, None, None]).any(axis=0)
    return float(np.sqrt(np.prod(high - low) * covered.mean() / np.pi))


def forecasts(
    recording: ddl.Recording, model: str, *, live: bool = True
) -> Iterator[tuple[float, list[ddl.Forecast], Floats]]:
    """For each frame its minute, the forecasts with fixed and (``live``) adaptive regions, and the later positions."""
    forecaster = ddl.Forecaster(model)
    step = float(recording.frame_step)
    xy = np.stack([recording.x, recording.y], axis=1)
    rows = {int(number): np.flatnonzero(recording.frame == number) for number in np.unique(recording.frame)}
    tracks = {one: np.flatnonzero(recording.id == one) for one in np.unique(recording.id).tolist()}

    def ahead(forecast: ddl.Forecast) -> Floats:
        of_each = [tracks[one] for one in forecast.ids.tolist()]
        return np.stack([later(recording.frame[of], xy[of], forecast.frame, step) for of in of_each])

    def minute(number: float) -> float:
        return float(number - recording.frame[0]) / step * STEP

    fixed = iter(forecaster.forecast_recording(recording, whole=True, every=0.4))
    if not live:
        yield from ((minute(one.frame), [one], ahead(one)) for one in fixed)
        return
    with ddl.Live(forecaster, fps=2.5 * step, whole=True, every=0.4) as place:
        for number, at in rows.items():
            adaptive = place.observe(number, recording.id[at].tolist(), xy[at])
            if adaptive is not None:
                yield minute(number), [next(fixed), adaptive], ahead(adaptive)


def later(frames: Floats, track: Floats, number: int, step: float) -> Floats:
    """(12, 2) positions after a frame: rows, or points between rows at most 1.2 s apart; NaN from the first missing."""
    ahead = number + step * np.arange(1, 13)
    after = np.searchsorted(frames, ahead).clip(1, len(frames) - 1)
    is_row = (frames[after] == ahead) | (frames[-1] == ahead)
    known = is_row | ((ahead < frames[-1]) & (frames[after] - frames[after - 1] <= 3 * step))
    positions = np.stack([np.interp(ahead, frames, track[:, axis]) for axis in (0, 1)], axis=1)
    return np.where(np.logical_and.accumulate(known)[:, None], positions, np.nan)


def coverage(recording: ddl.Recording, model: str) -> Coverage:
    rows: list[tuple[float, int, int, Floats, list[list[float]], Floats, list[list[list[float]]]]] = []
    for minute, kinds, ahead in forecasts(recording, model):
        valid = [kind.valid for kind in kinds]
        assert all(mask.all() for mask in valid) and kinds[0].paths.shape == kinds[1].paths.shape
        held, sums = [], []
        for forecast in kinds:
            radii = [forecast.regions(level) for level in LEVELS]
            held.append([inside(forecast, of_level, ahead).sum(axis=1) for of_level in radii])  # levels of pedestrians
            ends = [(forecast.paths[:, :, -1], radii[level][:, :, -1]) for level in (HALF, MOST)]
            sums.append([sum(map(equivalent_radius, centres, ends_of)) for centres, ends_of in ends])
        seen = (~np.isnan(ahead[..., 0])).sum(axis=1)
        of_each = [seen, *(kind[level] for kind in held for level in (HALF, MOST))]
        pace = paces(kinds[0].past)
        of_paces = np.array([[column[pace == which].sum() for column in of_each] for which in range(len(PACES))])
        wholes = [wholes_of(forecast, ahead) for forecast in kinds]
        rows.append((minute, len(ahead), int(seen.sum()), np.array(held).sum(axis=2), sums, of_paces, wholes))
    columns = [np.array(column, dtype=float) for column in zip(*rows, strict=True)]
    return Coverage(recording.name, model, *columns)


def table(coverages: Sequence[Coverage]) -> str:
    heads = (
        "recording (model) | minutes | forecasts | regions | 90 %: whole | later | any minute | radius | 50 %: whole"
    )
    lines = [f"| {heads} | later | radius | reliability |", "|" + "---|" * 12]
    for one in coverages:
        for kind, name in enumerate(KINDS):
            minutes = one.sliding(kind)
            minutes = minutes[minutes[:, 0] >= max(0.25 * one.minutes[-1], SLIDING), 1] if len(minutes) else minutes
            span = f"{100 * minutes.min():.0f} to {100 * minutes.max():.0f}" if len(minutes) else "-"
            off = np.abs([one.share(kind, k) - level for k, level in enumerate(LEVELS)])
            whole, later = ([100 * one.share(kind, k, part) for k in (MOST, HALF)] for part in (slice(None), one.later))
            head = (
                f"{one.name} (`{one.model}`) | {one.minutes[-1]:.1f} | {one.people.sum():.0f}" if kind == 0 else "| |"
            )
            most = f"{whole[0]:.1f} | {later[0]:.1f} | {span} | {one.radius(kind, 1):.2f}"
            half = f"{whole[1]:.1f} | {later[1]:.1f} | {one.radius(kind, 0):.2f}"
            reliability = f"{100 - 100 * off.mean():.1f} / {100 - 100 * off.max():.1f}"
            lines.append(f"| {head} | {name} | {most} | {half} | {reliability} |")
    return "\n".join(lines) + "\n"


def table_of_paces(coverages: Sequence[Coverage]) -> str:
    """Shares inside after the first quarter, fixed and adaptive, of paces with enough positions."""
    lines = [f"| recording | {' | '.join(PACES)} |", "|" + "---|" * 4]
    for one in coverages:
        shares = []
        for seen, *held in one.of_paces[one.later].sum(axis=0):
            half, most, half_adaptive, most_adaptive = (100 * share / max(seen, 1) for share in held)
            words = f"{half:.0f}/{most:.0f}, adaptive {half_adaptive:.0f}/{most_adaptive:.0f}"
            shares.append(words if seen >= 12 * LEAST else "-")
        lines.append(f"| {one.name} | {' | '.join(shares)} |")
    return "\n".join(lines) + "\n"


def table_of_wholes(coverages: Sequence[Coverage]) -> str:
    """Shares inside after the first quarter, and mean radii, of whole paths and of everybody."""
    heads = "paths | 90 % | 50 % | radius | moments | people | 90 % | 50 % | radius | stay"
    lines = [f"| recording (model) | regions | {heads} |", "|" + "---|" * 12]
    for one in coverages:
        people, moments = one.people[one.later].sum(), len(one.people[one.later])
        for kind, name in enumerate(KINDS):
            paths, scenes, stay = one.wholes[one.later, kind].sum(axis=0)
            of_paths, of_scenes = (
                f"{judged:.0f} | {100 * most / judged:.1f} | {100 * half / judged:.1f} | {radius / people:.2f}"
                for judged, half, most, radius in (paths, scenes)
            )
            number, shares = of_scenes.split(" | ", 1)
            row = [
                f"{one.name} (`{one.model}`)" if kind == 0 else "",
                name,
                of_paths,
                number,
                f"{people / moments:.1f}",
            ]
            lines.append(f"| {' | '.join(row)} | {shares} | {100 * stay[2] / stay[0]:.1f} |")
    return "\n".join(lines) + "\n"


def draw(coverages: Sequence[Coverage], path: str) -> None:
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "regions", "font.size": 9})
    figure, axes = plt.subplots(-(-len(coverages) // 3), 3, figsize=(10, 5.4), sharey=True, layout="constrained")
    for panel, one in zip(axes.flat, coverages, strict=False):
        panel.axhspan(88, 92, color="0.9")
        for kind, name in enumerate(KINDS):
            minutes = one.sliding(kind)
            note = f"{name}: {100 * one.share(kind, MOST, one.later):.0f} %, {one.radius(kind, 1):.1f} m"
            panel.plot(minutes[:, 0], 100 * minutes[:, 1].round(4), color=("C1", "C0")[kind], linewidth=1, label=note)
        panel.set(title=one.name, xlabel="minutes")
        panel.legend(loc="lower right", frameon=False)
    figure.suptitle("Share (%) of true positions inside the regions of 90 %, over the minute before")
    figure.savefig(path, metadata={"Date": None})


def measure(star: str, places: Sequence[str]) -> None:
    tested: list[Coverage] = []
    others: list[Coverage] = []
    for path in sorted(Path(star).glob("*.csv")):
        recording = ddl.read(path, format="star-csv")
        model = TESTED.get(path.stem)
        if model:
            tested.append(coverage(recording, model))
    for place in places:
        named, folder = place.split(":")
        for recording in recordings_of(folder, named):
            one = coverage(recording, named)
            minutes = (recording.frame[-1] - recording.frame[0]) / recording.frame_step * STEP
            if minutes >= SHORTEST and one.people.sum() >= FEWEST:
                others.append(one)
    print(f"# Recordings that are tested on\n\n{table(tested)}\n{table_of_paces(tested)}\n{table_of_wholes(tested)}")
    print(f"# Other recordings\n\n{table(others)}\n{table_of_paces(others)}\n{table_of_wholes(others)}")
    draw(tested, "regions.svg")


def scores(forecast: ddl.Forecast, truth: Floats) -> Floats:
    """(n, 12) scores of true positions: crates/ddl-core/src/region.rs has the formula."""
    assert forecast.spread is not None
    off = np.linalg.norm(truth[:, None] - forecast.paths, axis=-1) / forecast.spread[:, None]
    relative = forecast.weights / forecast.weights.max(axis=1, keepdims=True)
    least: Floats = (0.5 * off**2 - np.log(relative)[..., None]).min(axis=1)
    return least


def quantiles(scores: Floats, levels: Sequence[float]) -> Floats:
    """(levels, 12) split-conformal quantiles of scores (pedestrians, 12)."""
    ranks = np.ceil(np.array(levels) * (len(scores) + 1)).astype(int)
    ordered: Floats = np.sort(scores, axis=0)[ranks - 1]
    return ordered


def paces(past: Floats) -> NDArray[np.int64]:
    """(n,) 0 standing, 1 slow, 2 walking: crates/ddl-core/src/pace.rs has the limits."""
    speeds = np.linalg.norm(np.diff(past, axis=1), axis=-1).mean(axis=1) / 0.4
    pace: NDArray[np.int64] = np.digitize(speeds, [0.15, 0.7])
    return pace


def table_of(places: Sequence[tuple[NDArray[np.int64], Floats]], levels: Sequence[float]) -> Floats:
    """(paces, levels, 12) quantiles; each place with enough pedestrians of a pace counts the same."""
    tables = []
    for pace in range(3):
        of_places = [scores[of == pace] for of, scores in places if np.count_nonzero(of == pace) >= LEAST]
        if not of_places:
            sys.exit(f"too few pedestrians in the other folders: {PACES[pace]}")
        least = min(map(len, of_places))
        same = [scores[np.arange(least) * len(scores) // least] for scores in of_places]
        tables.append(quantiles(np.concatenate(same), levels))
    return np.array(tables)


def moments(place: str) -> list[tuple[NDArray[np.int64], Floats]]:
    """The paces and scores (n, 12) of each moment of a folder, NaN where a pedestrian was not seen."""
    model, folder = place.split(":")
    found = []
    for recording in recordings_of(folder, model):
        for _, [fixed], ahead in forecasts(recording, model, live=False):
            found.append((paces(fixed.past), scores(fixed, ahead)))
    return found


def wholes(places: Sequence[str]) -> None:
    """Fits the factors of crates/ddl-core/src/region/whole.rs; each place counts the same."""
    file = Path(__file__).parents[2] / "ddl/src/trust/calibration.json"
    constants: dict[str, Any] = json.loads(file.read_text())
    most = CALIBRATED.index(0.9)
    at_most = np.array(constants["regions"]["quantiles"])[:, most].clip(1e-3)  # (paces, 12)
    of_places = [[(pace, score / at_most[pace]) for pace, score in moments(place)] for place in places]
    whole = []
    for of_place in of_places:
        pace, largest = (np.concatenate(part) for part in zip(*((p, r.max(axis=1)) for p, r in of_place), strict=True))
        known = ~np.isnan(largest)
        whole.append((pace[known], np.repeat(largest[known, None], 12, axis=1)))
    paths = table_of(whole, CALIBRATED)[:, :, 0]
    rows: list[list[tuple[float, float]]] = [[] for _ in CALIBRATED]  # ln of the number and of the quantile
    for of_place in of_places:
        seen = [(len(pace), ratio / paths[pace, most, None]) for pace, ratio in of_place if not np.isnan(ratio).all()]
        number, largest = np.array([(n, np.nanmax(ratio)) for n, ratio in seen]).T
        classes = np.ceil(np.log2(number))  # 1, 2, 3 to 4, 5 to 8, ...
        for which in np.unique(classes):
            some = classes == which
            if some.sum() >= LEAST:
                found = quantiles(largest[some, None], CALIBRATED)[:, 0].clip(1e-3)
                for row, quantile in zip(rows, found, strict=True):
                    row.append((float(np.log(number[some]).mean()), float(np.log(quantile))))
    fits = [np.polyfit([n for n, _ in row], [q for _, q in row], 1).tolist() for row in rows]
    scenes = [[float(np.exp(one)), max(power, 0.0)] for power, one in fits]
    print("paths", paths.round(2), "scenes, of one and power", np.round(scenes, 2), sep="\n")
    constants["regions"]["wholes"] = {"paths": paths.round(4).tolist(), "scenes": np.round(scenes, 4).tolist()}
    write(file, constants)


def write(file: Path, constants: dict[str, Any]) -> None:
    # Rows of numbers on one line each.
    one_line = re.compile(r"\[[^][{}]*\]")
    text = json.dumps(constants, indent=2) + "\n"
    file.write_text(one_line.sub(lambda row: f"[{' '.join(row[0][1:-1].split())}]", text))
    print(file)


def calibrate(places: Sequence[str]) -> None:
    of_place = []
    for place in places:
        model, folder = place.split(":")
        windows = [window for recording in recordings_of(folder, model) for window in ddl.windows(recording)]
        windows = windows[:: max(1, -(-sum(len(window.past) for window in windows) // PEDESTRIANS))]
        forecaster = ddl.Forecaster(model)
        scored = [scores(forecaster.forecast(window.past), window.future) for window in windows]
        of_place.append((paces(np.concatenate([window.past for window in windows])), np.concatenate(scored)))
    for left_out, place in enumerate(places):
        pace, own = of_place[left_out]
        others = table_of([of for index, of in enumerate(of_place) if index != left_out], [0.5, 0.9])
        for name, some in [("all", pace >= 0), *((name, pace == which) for which, name in enumerate(PACES))]:
            held = [(own[some] <= others[pace[some], row]).mean() for row in (0, 1)] if some.any() else []
            print(place, name, int(some.sum()), *(f"{share:.1%}" for share in held))
    file = Path(__file__).parents[2] / "ddl/src/trust/calibration.json"
    constants: dict[str, Any] = json.loads(file.read_text())
    rows = table_of(of_place, CALIBRATED).round(4).tolist()
    constants["regions"] |= {"levels": CALIBRATED, "quantiles": rows}
    write(file, constants)


if __name__ == "__main__":
    warnings.simplefilter("ignore", ddl.DoubtWarning)
    match sys.argv[1:]:
        case ["measure", star, *places]:
            measure(star, places)
        case ["calibrate", first, *places]:
            calibrate([first, *places])
        case ["wholes", first, *places]:
            wholes([first, *places])
        case _:
            sys.exit(__doc__)
