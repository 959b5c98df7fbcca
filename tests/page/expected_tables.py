"""The tables of a report page, computed again from report.json."""

import math

# Headings of the first column of tables of the literature.
UNCAPTIONED = {"method", "variant", "baseline"}

MOTIONS = {
    "standing": "standing",
    "straight": "straight on",
    "turning-left": "turning left",
    "turning-right": "turning right",
    "slowing-down": "slowing down",
    "speeding-up": "speeding up",
}


# The captions of the main tables.
HEADLINES = "minADE/minFDE in metres. ", "JADE/JFDE in metres. "


def add(values):
    """The plain sum in order, as in Rust; Python's own `sum` compensates rounding errors."""
    total = 0.0
    for value in values:
        total += value
    return total


def spread(values, decimals):
    """The mean, with the sample deviation if there are several values."""
    mean = add(values) / len(values)
    text = f"{mean:.{decimals}f}"
    if len(values) > 1:
        squares = add((value - mean) * (value - mean) for value in values)
        text += f"±{math.sqrt(squares / (len(values) - 1)):.{decimals}f}"
    return text


def rule_name(rule):
    if isinstance(rule, str):
        return rule
    ((name, fields),) = rule.items()
    return f"{name}-{fields['min_pedestrians']}"


class Group:
    """Rows of one convention, window rule, protocol and scored part."""

    def __init__(self, rows, convention, rule, protocol, subset):
        wanted = (convention, rule, protocol, subset)
        self.protocol = protocol
        self.errors = ("joint_ade", "joint_fde") if protocol == "joint" else ("min_ade", "min_fde")
        self.lines = []
        for row in rows:
            c = row["conditions"]
            of = (c["convention"], rule_name(c["window_rule"]), c["protocol"], c["test_subset"])
            if of != wanted:
                continue
            alike = {key: value for key, value in c.items() if key not in ("fold", "seed")}
            for line in self.lines:
                if line["alike"] == alike:
                    line["rows"].append(row)
                    break
            else:
                self.lines.append({"alike": alike, "rows": [row]})
        names = []
        for line in self.lines:
            c = line["alike"]
            variant = c["variant"]
            names.append(c["forecaster"] if variant in (None, "full") else f"{c['forecaster']} ({variant})")
        for at, line in enumerate(self.lines):
            name = names[at]
            line["label"] = f"{name} #{names[: at + 1].count(name)}" if names.count(name) > 1 else name

    def on(self, line, fold, of):
        return [of(row["scores"]) for row in line["rows"] if row["conditions"]["fold"] == fold]

    def over(self, line, folds, of):
        """One mean over the folds for each seed; None unless every seed has every fold."""
        seeds = sorted({row["conditions"]["seed"] for row in line["rows"]}, key=lambda s: (s is not None, s or 0))
        means = []
        for seed in seeds:
            values = []
            for fold in folds:
                found = [
                    row["scores"]
                    for row in line["rows"]
                    if row["conditions"]["fold"] == fold and row["conditions"]["seed"] == seed
                ]
                if not found:
                    return None
                values.append(of(found[0]))
            means.append(add(values) / len(folds))
        return means

    def cells(self, line, folds):
        """The two errors of the protocol on each fold, and their mean."""
        ade, fde = ((lambda s, of=of: s[of]) for of in self.errors)
        cells = []
        for fold in folds:
            pair = self.on(line, fold, ade), self.on(line, fold, fde)
            cells.append("/".join(spread(values, 3) for values in pair) if pair[0] else "-")
        means = self.over(line, folds, ade), self.over(line, folds, fde)
        cells.append("/".join(spread(values, 3) for values in means) if means[0] else "-")
        return cells


def stability(name, factor=1.0):
    return lambda s: None if s["stability"] is None or s["stability"][name] is None else factor * s["stability"][name]


FURTHER = {
    "FDE@minADE m": (3, lambda s: s["fde_at_min_ade"]),
    "missed %": (1, lambda s: 100.0 * s["miss_rate"]),
    "collide %": (1, lambda s: 100.0 * s["collision_rate"]),
    "(true %)": (1, lambda s: 100.0 * s["true_collision_rate"]),
    "goal FDE m": (3, lambda s: s["goal_fde"]),
    "Phi falls %": (1, stability("decreasing", 100.0)),
    "certified %": (1, stability("certified", 100.0)),
    "to goal m": (3, stability("end_distance")),
    "turn deg": (1, stability("largest_turn")),
    "reverse %": (1, stability("reversing", 100.0)),
    "K": (0, lambda s: float(s["hypotheses"])),
}

JOINT = {
    "minADE m": (3, lambda s: s["min_ade"]),
    "minFDE m": (3, lambda s: s["min_fde"]),
    "JADE by window m": (3, lambda s: s["joint"]["ade_windows"]),
    "JFDE by window m": (3, lambda s: s["joint"]["fde_windows"]),
    "of all futures %": (1, lambda s: 100.0 * s["joint"]["collisions"]["mean"]),
    "of the best %": (1, lambda s: 100.0 * s["joint"]["collisions"]["best"]),
    "of the true one %": (1, lambda s: 100.0 * s["joint"]["collisions"]["truth"]),
    "CR_mean": (3, lambda s: s["joint"]["close_collisions"]["mean"]),
    "CR_JADE": (3, lambda s: s["joint"]["close_collisions"]["best"]),
    "CR of the truth": (3, lambda s: s["joint"]["close_collisions"]["truth"]),
}

WHOLE_FORECAST = {
    "ADE@minFDE m": (3, lambda s: s["ade_at_min_fde"]),
    "expected ADE m": (3, lambda s: s["expected_ade"]),
    "expected FDE m": (3, lambda s: s["expected_fde"]),
    "likely ADE m": (3, lambda s: s["most_likely_ade"]),
    "likely FDE m": (3, lambda s: s["most_likely_fde"]),
    "missed 1 m %": (1, lambda s: 100.0 * s["miss_rate_1m"]),
    "missed 2 m %": (1, lambda s: 100.0 * s["miss_rate_2m"]),
    "runs into %": (1, lambda s: 100.0 * s["true_neighbour_collision_rate"]),
    "KDE NLL nats": (3, lambda s: s["kde_nll"]),
    "AMD": (3, lambda s: s["amd"]),
    "AMV m²": (3, lambda s: s["amv"]),
    "APD m": (3, lambda s: s["diversity"]),
    "FPD m": (3, lambda s: s["end_diversity"]),
}

# Smallest number of 20 s stretches per fold for which an interval is reported.
FEWEST_BLOCKS = 10


def headline(group, header):
    folds = header[1:-1]
    pedestrians = []
    for fold in folds:
        counts = sorted({n for line in group.lines for n in group.on(line, fold, lambda s: s["pedestrians"])})
        pedestrians.append(" or ".join(map(str, counts)) or "-")
    rows = [["pedestrians scored", *pedestrians, ""]]
    return rows + [[line["label"], *group.cells(line, folds)] for line in group.lines]


def further(group, header, folds, columns):
    unknown = [name for name in header[2:] if name not in columns]
    assert not unknown, f"columns {unknown} are unknown to this check: add them"
    rows = []
    for line in group.lines:
        present = [fold for fold in folds if group.on(line, fold, lambda s: 0)]
        row = [line["label"], "all" if present == folds else ", ".join(present)]
        for name in header[2:]:
            decimals, of = columns[name]
            known = all(of(r["scores"]) is not None for r in line["rows"])
            means = group.over(line, present, of) if known else None
            row.append(spread(means, decimals) if means else "-")
        rows.append(row)
    return rows


def of_fold(line, fold):
    return [row for row in line["rows"] if row["conditions"]["fold"] == fold]


def block_mean(line, folds, error):
    """Mean over the folds of the mean error over blocks, seeds averaged; None where a fold has too few blocks."""
    means = []
    for fold in folds:
        rows = of_fold(line, fold)
        blocks = [row.get("blocks", []) for row in rows]
        if any(len(of_seed) < FEWEST_BLOCKS for of_seed in blocks):
            return None
        total = sum(block[error] for of_seed in blocks for block in of_seed) / len(blocks)
        means.append(total / sum(block["pedestrians"] for block in blocks[0]))
    return sum(means) / len(means)


def intervals(group, table):
    """The found rows, after checks that their means are right and lie inside their intervals."""
    reference = table["header"][4].split(" - ", 1)[1].removesuffix(" m")
    lines = {line["label"]: line for line in group.lines}
    for row in table["rows"]:
        line = lines[row[0]]
        folds = [fold for fold in table["folds"] if of_fold(line, fold)]
        alike = folds == [fold for fold in table["folds"] if of_fold(lines[reference], fold)]
        for at, error in ((2, "min_ade"), (3, "min_fde")):
            mean = block_mean(line, folds, error)
            check_interval(row[at], mean)
            if mean is None or not alike or row[0] == reference:
                assert row[2 * at : 2 * at + 2] == ["-", "-"], row
                continue
            check_interval(row[2 * at], mean - block_mean(lines[reference], folds, error))
            assert 0.0 < float(row[2 * at + 1].replace("<0.001", "0.0005")) <= 1.0, row
    return table["rows"]


def check_interval(cell, mean):
    if mean is None:
        assert cell == "-", cell
        return
    shown, low, high = (float(part.strip("[],")) for part in cell.split())
    assert abs(shown - mean) < 0.00051 and low <= shown <= high, (cell, mean)


def categories(group, header, caption):
    """Errors by kind of motion, pooled over the pedestrians of the folds that all forecasters have."""
    folds = caption.split("pooled over ")[1].split(". ")[0].split(", ")
    lines = [line for line in group.lines if all(row["scores"]["categories"] for row in line["rows"])]
    assert header[2:] == [line["label"] for line in lines], header
    present = [scores["category"] for line in lines for row in line["rows"] for scores in row["scores"]["categories"]]
    rows = []
    for motion, name in MOTIONS.items():
        if {"motion": motion} not in present:
            continue
        cells, pedestrians = [], set()
        for line in lines:
            count, ade, fde = 0, 0.0, 0.0
            for fold in folds:
                found = [
                    scores
                    for row in of_fold(line, fold)
                    for scores in row["scores"]["categories"]
                    if scores["category"] == {"motion": motion}
                ]
                if found:
                    weight = found[0]["pedestrians"]
                    count += weight
                    ade += weight * sum(s[group.errors[0]] for s in found) / len(found)
                    fde += weight * sum(s[group.errors[1]] for s in found) / len(found)
            if count:
                pedestrians.add(count)
                cells.append(f"{ade / count:.3f}/{fde / count:.3f}")
            else:
                cells.append("-")
        rows.append([name, " or ".join(map(str, sorted(pedestrians))), *cells])
    return rows


def by_protocol(groups, header):
    rows = []
    for group in groups:
        for line in group.lines:
            c = line["alike"]
            trained = c["epochs"] is not None
            goals = line["rows"][0]["scores"]["goal_fde"] is not None
            name = c["forecaster"]
            if not (trained or (goals and "the TRUE end" not in name) or "nearest the TRUE end" in name):
                continue
            candidates = str(line["rows"][0]["scores"]["hypotheses"])
            if group.protocol == "published":
                candidates = " x ".join(["20 goals"] * goals + [f"{candidates} samples"] * (candidates != "1"))
            rows.append([line["label"], group.protocol, candidates, *group.cells(line, header[3:-1])])
    return rows


def deployable(single, fair, header):
    """ADE/FDE (CVaR95) of one path without the truth, mean over seeds."""
    folds = header[1:-1]
    of_several = [(", likeliest", "likeliest"), (", medoid", "medoid")]
    named = [(single, line, line["label"], "likeliest") for line in single.lines]
    several = [line for line in fair.lines if line["rows"][0]["scores"]["hypotheses"] > 1]
    named += [(fair, line, line["label"] + words, of) for line in several for words, of in of_several]
    rows = []
    for group, line, label, of in named:
        errors = [lambda s, of=of, key=key: s[of][key] for key in ("ade", "fde", "worst_ade")]
        each = [[group.on(line, fold, error) for error in errors] for fold in folds]
        each.append([group.over(line, folds, error) for error in errors])
        means = [[add(values) / len(values) for values in cell] if cell[0] else None for cell in each]
        rows.append([label, *("{:.3f}/{:.3f} ({:.2f})".format(*cell) if cell else "-" for cell in means)])
    return rows


def expected(table, report):
    """The expected rows of a table; None for tables of the literature, which are not in report.json."""
    caption, header, codes = table["caption"], table["header"], table["codes"]
    if not caption:
        assert header[0] in UNCAPTIONED, f"the table headed {header} is unknown to this check"
        return None
    rows = report["rows"]
    scored = caption.split("scored: ")[1].rstrip(".") if "scored: " in caption else None
    subset = None if scored == "all test windows" else scored
    if caption.startswith(HEADLINES):
        return headline(Group(rows, *codes[:3], subset), header)
    if caption.startswith("Further metrics. "):
        group = Group(rows, *codes[:3], subset)
        return further(group, header, table["folds"], FURTHER)
    if caption.startswith("Futures of scenes. "):
        return further(Group(rows, *codes[:3], subset), header, table["folds"], JOINT)
    if caption.startswith("The forecast as a whole. "):
        return further(Group(rows, *codes[:3], subset), header, table["folds"], WHOLE_FORECAST)
    if caption.startswith("95 % intervals and paired differences. "):
        return intervals(Group(rows, *codes[:3], subset), table)
    if " in metres by kind of motion" in caption:
        return categories(Group(rows, *codes[:3], subset), header, caption)
    if caption.startswith("minADE/minFDE in metres by protocol."):
        groups = [Group(rows, codes[0], codes[1], protocol, subset) for protocol in ("published", "fair", "single")]
        return by_protocol(groups, header)
    if caption.startswith("One path for each pedestrian, chosen without the truth"):
        single, fair = (Group(rows, *codes[:2], protocol, subset) for protocol in ("single", "fair"))
        return deployable(single, fair, header)
    raise AssertionError(f"the table `{caption}` is unknown to this check")
