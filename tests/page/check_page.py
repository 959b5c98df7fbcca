"""Opens a report page in a browser and compares it with report.json and moments.json.

    check_page.py FOLDER --browser /path/to/chromium [--screenshots FOLDER]

FOLDER is the output of make_page.py. The page is opened from the file system, in light and
dark, wide and narrow, and must send no network request.
"""

import argparse
import json
import math
import pathlib
import sys
import tempfile
import time

from check_futures import check_futures
from expected_tables import HEADLINES, Group, expected, spread
from playwright.sync_api import sync_playwright

HERE = pathlib.Path(__file__).parent
WIDE = {"width": 1280, "height": 800}
NARROW = {"width": 390, "height": 844}


def wait_for(page, condition, argument=None, seconds=20):
    """Waits until a condition holds. The browser's own waiting evaluates text in the page, which its policy forbids."""
    end = time.monotonic() + seconds
    while not page.evaluate(condition, argument):
        assert time.monotonic() < end, f"{condition} does not hold after {seconds} s"
        page.wait_for_timeout(20)


class Opened:
    """A page in a browser, with its errors, warnings and requests."""

    def __init__(self, browser, path, viewport=WIDE, scheme="light", motion="no-preference"):
        self.context = browser.new_context(
            viewport=viewport, color_scheme=scheme, reduced_motion=motion, has_touch=viewport is NARROW
        )
        self.page = self.context.new_page()
        self.faults = []
        self.page.on("console", lambda m: m.type in ("error", "warning") and self.faults.append(f"console: {m.text}"))
        self.page.on("pageerror", lambda e: self.faults.append(f"page error: {e}"))
        address = path.as_uri()
        self.page.on(
            "request", lambda r: r.url not in (address, "data:,") and self.faults.append(f"request: {r.url[:200]}")
        )
        self.page.set_default_timeout(20_000)
        self.page.goto(address)
        self.page.evaluate("document.documentElement.style.scrollBehavior = 'auto'")
        # Collapsed parts are checked as well.
        self.page.evaluate("document.querySelectorAll('details').forEach((details) => (details.open = true))")

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is None:
            assert not self.faults, self.faults
        self.context.close()

    def text(self, selector):
        return self.page.locator(selector).inner_text()

    def time(self):
        return float(self.page.locator("#scene").get_attribute("data-time"))

    def picture(self):
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return self.page.evaluate("document.getElementById('scene').toDataURL()")


def embedded(opened, name):
    return opened.page.evaluate("(id) => document.getElementById(id).textContent", name)


def check_tables(opened, report):
    tables = opened.page.evaluate(
        """() => [...document.querySelectorAll(".tables table")].map((table) => ({
            caption: table.caption?.textContent ?? "",
            codes: [...(table.caption?.querySelectorAll("code") ?? [])].map((code) => code.textContent),
            header: [...table.tHead.rows[0].cells].map((cell) => cell.textContent),
            rows: [...table.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent)),
            section: table.closest("section").className,
            warnings: table.closest("section").querySelectorAll(".warning").length,
        }))"""
    )
    folds, compared = [], 0
    for table in tables:
        if table["caption"].startswith(HEADLINES):
            folds = table["header"][1:-1]
        rows = expected(table | {"folds": folds}, report)
        if "published" in table["codes"][2:3] or "by protocol" in table["caption"]:
            assert table["warnings"] == 1 and table["section"] == "warned", f"no warning at `{table['caption']}`"
        if rows is None:
            continue
        assert rows == table["rows"], f"`{table['caption']}`\nexpected {rows}\nfound    {table['rows']}"
        compared += sum(len(row) - 1 for row in rows)
    groups = {
        (c["convention"], json.dumps(c["window_rule"]), c["protocol"], c["test_subset"])
        for c in (row["conditions"] for row in report["rows"])
    }
    shown = sum(table["caption"].startswith(HEADLINES) for table in tables)
    assert shown == len(groups), f"{shown} headline tables for {len(groups)} groups"
    return compared


def check_headline(opened, report):
    group = Group(report["rows"], "simulated", "published", "fair", None)
    folds = list(dict.fromkeys(row["conditions"]["fold"] for row in report["rows"]))
    # Nothing is trained, so the page is about the forecasts of a file.
    subject = next(line for line in group.lines if line["label"] == "stand-in")
    for name, of in (("minADE", "min_ade"), ("minFDE", "min_fde")):
        values = group.over(subject, folds, lambda s: s[of])
        shown = opened.text(f"[data-number={name}]")
        assert shown == spread([sum(values) / len(values)], 3), (name, shown)
    assert subject["label"] in opened.text(".verdict")
    chart = [text.strip() for text in opened.page.locator(".comparison .wide text").all_text_contents()]
    for line in group.lines:
        for fold in folds:
            values = group.on(line, fold, lambda s: s["min_ade"])
            assert f"{sum(values) / len(values):.3f}" in chart, (line["label"], fold)


def decoded(data):
    """The compact moments in the form of moments.json."""
    for moment in data:
        pedestrians = []
        for w in moment["pedestrians"]:
            observed, last = path([0, 0], w["observed"])
            hypotheses = []
            for k, steps in enumerate(w["paths"]):
                h = {"weight": w["weights"][k] / 1000, "positions": path(last, steps)[0]}
                if w["goals"][k]:
                    h["goal"] = [(last[axis] + w["goals"][k][axis]) / 1000 for axis in (0, 1)]
                for name, letters in (("decreasing", w["falls"]), ("certified", w["certified"])):
                    if letters[k] != "-":
                        h[name] = letters[k] == "y"
                hypotheses.append(h)
            truth = path(last, w["truth"])[0]
            pedestrians.append(
                {"pedestrian": w["pedestrian"], "observed": observed, "truth": truth, "hypotheses": hypotheses}
            )
        out = {key: moment[key] for key in ("fold", "forecaster", "recording", "frame")}
        out |= {"frame_step": moment["frameStep"], "pedestrians": pedestrians}
        yield out


def path(start, steps):
    x, y = start
    places = []
    for dx, dy in zip(steps[::2], steps[1::2]):
        x, y = x + dx, y + dy
        places.append([x / 1000, y / 1000])
    return places, (x, y)


def errors(pedestrian):
    distances = [
        [math.dist(p, q) for p, q in zip(h["positions"], pedestrian["truth"])] for h in pedestrian["hypotheses"]
    ]
    return [sum(d) / 12 for d in distances], [d[-1] for d in distances]


def same(shown, value):
    """Whether a value is printed to a millimetre, within its last digit: sums may differ in their last bit."""
    return abs(float(shown) - value) <= 0.000_501


def check_pedestrian(opened, moment, at):
    pedestrian = moment["pedestrians"][at]
    ade, fde = errors(pedestrian)
    assert opened.text("#pedestrian-name") == f"Pedestrian {pedestrian['pedestrian']}"
    assert same(opened.text("#min-ade"), min(ade)) and same(opened.text("#min-fde"), min(fde)), moment["frame"]
    rows = opened.page.evaluate(
        "[...document.querySelectorAll('#hypotheses tbody tr')]"
        ".map((row) => [...row.cells].map((cell) => cell.textContent))"
    )
    assert len(rows) == len(pedestrian["hypotheses"])
    weights = [float(row[1]) for row in rows]
    assert weights == sorted(weights, reverse=True)
    for row in rows:
        k = int(row[0]) - 1
        h = pedestrian["hypotheses"][k]
        assert float(row[1]) == h["weight"] and same(row[2], ade[k]) and same(row[3], fde[k]), row
        if h.get("goal") is None:
            assert row[4].startswith("no goal"), row
        else:
            assert ("falls at each of 12 steps" in row[4]) == h["decreasing"], row
            verdict = {True: "; certified", False: "; not certified", None: "steps"}[h.get("certified")]
            assert row[4].endswith(verdict) or h.get("certified") is None, row


def check_player(opened, moments):
    page = opened.page
    page.locator("#player").scroll_into_view_if_needed()
    first = moments[0]
    check_pedestrian(opened, first, 0)

    # At the opening moment the speed is that of the last observed step.
    pedestrian = first["pedestrians"][0]
    (x, y), speed = pedestrian["observed"][7], math.dist(*pedestrian["observed"][6:8]) / 0.4
    assert opened.time() == 7
    assert opened.text("#now-words") == f"observed at ({x:.2f}, {y:.2f}) m, {speed:.2f} m/s", opened.text("#now-words")

    # The player plays, by button and by key.
    before, picture, words = opened.time(), opened.picture(), opened.text("#now-words")
    page.click("#play")
    wait_for(page, "(t) => Number(document.getElementById('scene').dataset.time) > t + 0.5", before)
    page.click("#play")
    assert opened.time() > before and opened.picture() != picture and opened.text("#now-words") != words
    page.focus(".stage")
    page.keyboard.press("Home")
    assert opened.time() == 0 and "observed step 1 of 8" in opened.text("#time-words")
    for step in range(1, 20):
        page.keyboard.press("ArrowRight")
        assert opened.time() == step
    assert "forecast step 12 of 12" in opened.text("#time-words")
    page.keyboard.press("ArrowLeft")
    assert opened.time() == 18 and page.input_value("#time") == "19"
    page.keyboard.press("End")
    best = max(first["pedestrians"][0]["hypotheses"], key=lambda h: h["weight"])
    x, y = best["positions"][11]
    assert f"({x:.2f}, {y:.2f})" in opened.text("#now-words"), opened.text("#now-words")
    page.keyboard.press("Home")
    page.keyboard.press(" ")
    wait_for(page, "Number(document.getElementById('scene').dataset.time) > 0.2")
    assert page.get_attribute("#play", "aria-label") == "Pause"
    page.keyboard.press(" ")
    stopped = opened.time()
    opened.picture()
    assert opened.time() == stopped and page.get_attribute("#play", "aria-pressed") == "false"

    # The slider scrubs.
    page.locator("#time").fill("20")
    assert opened.time() == 19

    # Pedestrians, moments and recordings, by key and by choice.
    page.focus(".stage")
    count = len(first["pedestrians"])
    page.keyboard.press("ArrowDown")
    check_pedestrian(opened, first, 1 % count)
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    check_pedestrian(opened, first, -1 % count)
    page.keyboard.press("n")
    assert page.input_value("#choose-moment") == "1"
    page.keyboard.press("p")
    assert page.input_value("#choose-moment") == "0"
    recording = page.input_value("#choose-recording")
    page.keyboard.press("r")
    assert page.input_value("#choose-recording") != recording
    page.select_option("#choose-recording", recording)
    assert page.input_value("#choose-recording") == recording
    for at in range(0, len(moments), 7):
        moment = moments[at]
        page.select_option(
            "#choose-recording",
            label=page.evaluate(
                "(at) => JSON.parse(document.getElementById('moments-json').textContent)[at].recording", at
            ),
        )
        page.select_option("#choose-moment", str(at))
        who = at % len(moment["pedestrians"])
        page.select_option("#choose-pedestrian", str(who))
        check_pedestrian(opened, moment, who)

    # Switches change the picture.
    page.focus(".stage")
    for key in "thgoez":
        before = opened.picture()
        page.keyboard.press(key)
        assert opened.picture() != before, f"key {key} changes nothing"
        page.keyboard.press(key)
        assert opened.picture() == before, f"key {key} pressed twice does not restore the picture"
    page.click("#hypotheses button[data-sort=ade]")
    ades = page.evaluate(
        "[...document.querySelectorAll('#hypotheses tbody tr')].map((row) => Number(row.cells[2].textContent))"
    )
    assert ades == sorted(ades)
    page.focus(".stage")
    page.keyboard.press("w")
    before = opened.text("#certificate-words")
    page.locator("#hypotheses tbody tr").nth(1).click()
    assert opened.text("#certificate-words") != before
    page.keyboard.press("?")
    assert page.locator("#keys").is_visible()
    page.keyboard.press("Escape")
    assert not page.locator("#keys").is_visible()


def check_viewer(opened):
    """The player alone starts at the moment with the most known futures, and hides errors where none are known."""
    moments = list(decoded(json.loads(embedded(opened, "moments-json"))))
    known = [sum(len(pedestrian["truth"]) == 12 for pedestrian in moment["pedestrians"]) for moment in moments]
    assert 0 in known and max(known) > 0, known
    chosen = int(opened.page.locator("#choose-moment").input_value())
    assert known[chosen] == max(known), (chosen, known)
    errors_seen = ["#min-ade", "#min-fde", "#hypotheses thead [data-sort=ade]", "#hypotheses tbody td:nth-child(4)"]

    def shown(pedestrian, measured):
        for selector in errors_seen:
            assert opened.page.locator(selector).first.is_visible() == measured, (selector, measured)
        said = f"observed for {len(pedestrian['truth'])} of the 12" in opened.text("#convention-words")
        assert said != measured, opened.text("#convention-words")
        assert "the representative one" in opened.text("#certificate-words")

    pedestrians = moments[chosen]["pedestrians"]
    shown(pedestrians[int(opened.page.locator("#choose-pedestrian").input_value())], True)
    opened.page.select_option("#choose-moment", str(known.index(0)))
    for at, pedestrian in enumerate(moments[known.index(0)]["pedestrians"]):
        opened.page.select_option("#choose-pedestrian", str(at))
        shown(pedestrian, False)


def check_theme(opened):
    """The button switches from the system's colours to light and to dark, and the picture changes with it."""
    paper = "getComputedStyle(document.body).backgroundColor"
    light, picture = opened.page.evaluate(paper), opened.picture()
    opened.page.click("#theme")
    assert opened.page.evaluate(paper) == light
    opened.page.click("#theme")
    assert opened.page.evaluate(paper) != light and opened.picture() != picture
    opened.page.click("#theme")
    assert opened.page.evaluate(paper) == light and opened.picture() == picture


def check_touch(opened, moments):
    """Touch plays, stops, and chooses a pedestrian."""
    before = opened.time()
    opened.page.tap("#play")
    wait_for(opened.page, "(t) => Number(document.getElementById('scene').dataset.time) > t + 0.5", before)
    opened.page.tap("#play")
    opened.page.check("#show-whole")
    chosen = {opened.text("#pedestrian-name")}
    box = opened.page.locator("#scene").bounding_box()
    for across in range(1, 12):
        for down in (0.35, 0.45, 0.5, 0.55, 0.65):
            opened.page.locator("#scene").tap(position={"x": box["width"] * across / 12, "y": box["height"] * down})
            chosen.add(opened.text("#pedestrian-name"))
    names = {f"Pedestrian {pedestrian['pedestrian']}" for pedestrian in moments[0]["pedestrians"]}
    assert 1 < len(chosen) and chosen <= names, chosen


def check_focus(opened):
    """Every element reached by the tab key shows its focus."""
    seen = []
    for _ in range(40):
        opened.page.keyboard.press("Tab")
        style, name = opened.page.evaluate(
            "[getComputedStyle(document.activeElement).outlineStyle,"
            " document.activeElement.id || document.activeElement.className]"
        )
        assert style != "none" or name == "time", f"the focus on {name} cannot be seen"
        seen.append(name)
    assert {"stage", "play", "time", "choose-pedestrian", "theme"} <= set(seen), seen


def check_reduced_motion(opened):
    opened.page.focus(".stage")
    opened.page.keyboard.press("Home")
    opened.page.evaluate(
        """() => {
            window.times = [];
            new MutationObserver(() => window.times.push(Number(document.getElementById("scene").dataset.time)))
                .observe(document.getElementById("scene"), { attributes: true });
        }"""
    )
    opened.page.keyboard.press(" ")
    wait_for(opened.page, "Math.max(...window.times) >= 3")
    opened.page.keyboard.press(" ")
    times = opened.page.evaluate("window.times")
    assert all(time == int(time) and 0 <= time <= 19 for time in times), times


def check_unclipped(opened):
    """Choices and the list of hypotheses fit into their boxes, whatever the width."""
    clipped = opened.page.evaluate(
        """() => {
            const pen = document.createElement("canvas").getContext("2d");
            const cut = (select) => {
                const { fontSize, fontFamily, paddingLeft, paddingRight } = getComputedStyle(select);
                pen.font = `${fontSize} ${fontFamily}`;
                const room = select.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight) - ARROW;
                return pen.measureText(select.selectedOptions[0].text).width > room;
            };
            const table = document.querySelector(".hypotheses .table");
            return [...[...document.querySelectorAll(".choices select")].filter(cut).map((select) => select.id),
                ...(table.scrollWidth > table.clientWidth ? [`the list of hypotheses, ${table.scrollWidth} px`] : [])];
        }""".replace("ARROW", "18")
    )
    assert not clipped, clipped


def check_looks(opened, width):
    overflow = opened.page.evaluate("Math.max(document.documentElement.scrollWidth, document.body.scrollWidth)")
    assert overflow <= width, f"the body is {overflow} px wide in a window of {width} px"
    found = opened.page.evaluate((HERE / "contrast.js").read_text())
    assert found["seen"] > 50 and not found["faults"], found
    ids = opened.page.evaluate("[...document.querySelectorAll('[id]')].map((element) => element.id)")
    assert len(ids) == len(set(ids)), "an id is not unique"
    unnamed = opened.page.evaluate(
        """[...document.querySelectorAll("button, select, input")].filter((e) =>
            !e.textContent.trim() && !e.getAttribute("aria-label") && !e.labels?.length).map((e) => e.outerHTML)"""
    )
    assert not unnamed, unnamed


def variant(html, folder, name, moments):
    """The page with other moments."""
    start = html.index('id="moments-json">') + len('id="moments-json">')
    end = html.index("</script>", start)
    page = folder / f"{name}.html"
    page.write_text(html[:start] + json.dumps(moments) + html[end:])
    return page


def variants(html, data, folder):
    one = json.loads(json.dumps(data[0]))
    for pedestrian in one["pedestrians"]:
        for name in ("paths", "goals", "weights", "falls", "certified"):
            pedestrian[name] = pedestrian[name][:1]
        pedestrian["goals"], pedestrian["weights"], pedestrian["falls"], pedestrian["certified"] = (
            [None],
            [1000],
            "-",
            "-",
        )
        pedestrian["representative"] = 0
    one["pedestrians"] = one["pedestrians"][:1]
    yield variant(html, folder, "one-hypothesis", [one])
    crowd = max(data, key=lambda moment: len(moment["pedestrians"]))
    for count in (25, 60):
        pedestrians = []
        for at in range(count):
            pedestrian = json.loads(json.dumps(crowd["pedestrians"][at % len(crowd["pedestrians"])]))
            pedestrian["pedestrian"] = at
            pedestrian["observed"][0] += 700 * (at // len(crowd["pedestrians"]))
            pedestrians.append(pedestrian)
        yield variant(html, folder, f"{count}-pedestrians", [crowd | {"pedestrians": pedestrians}])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--browser", required=True)
    parser.add_argument("--screenshots", type=pathlib.Path)
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    path_of_page, report_text = folder / "report.html", (folder / "report.json").read_text()
    report, moments = json.loads(report_text), json.loads((folder / "moments.json").read_text())

    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as temporary:
        browser = playwright.chromium.launch(executable_path=arguments.browser, args=["--no-sandbox"])
        with Opened(browser, path_of_page) as opened:
            assert embedded(opened, "report-json") == report_text, "the embedded report.json differs from the file"
            data = json.loads(embedded(opened, "moments-json"))
            assert list(decoded(data)) == moments, "the compact moments differ from moments.json"
            compared = check_tables(opened, report)
            check_headline(opened, report)
            print(f"tables: {compared} cells agree with report.json")
        with Opened(browser, path_of_page) as opened:
            check_player(opened, moments)
            print(f"player: {len(moments)} moments, numbers agree with moments.json")
        with Opened(browser, folder / "viewer.html") as opened:
            check_viewer(opened)
            assert not opened.page.locator(".futures").is_visible(), "a slider of futures without joint futures"
        with Opened(browser, folder / "joint.html") as opened:
            conflicts = check_futures(opened, list(decoded(json.loads(embedded(opened, "moments-json")))))
            print(f"joint futures: {conflicts} conflicts agree with the paths")
        with Opened(browser, path_of_page) as opened:
            check_theme(opened)
        with Opened(browser, path_of_page, NARROW) as opened:
            check_touch(opened, moments)
        with Opened(browser, path_of_page, motion="reduce") as opened:
            check_focus(opened)
            check_reduced_motion(opened)
        pages = {"page": path_of_page, "viewer": folder / "viewer.html", "joint": folder / "joint.html"}
        pages |= {page.stem: page for page in variants(path_of_page.read_text(), data, pathlib.Path(temporary))}
        for name, page in pages.items():
            for size, viewport in (("wide", WIDE), ("narrow", NARROW)):
                for scheme in ("light", "dark"):
                    with Opened(browser, page, viewport, scheme) as opened:
                        check_looks(opened, viewport["width"])
                        check_unclipped(opened)
                        if size == "wide" and scheme == "light":
                            spent = opened.page.evaluate("window.ddlPlayer.measure(50)")
                            print(f"{name}: a picture with the hypotheses of all pedestrians takes {spent:.1f} ms")
                        if arguments.screenshots:
                            arguments.screenshots.mkdir(parents=True, exist_ok=True)
                            opened.page.screenshot(
                                path=arguments.screenshots / f"{name}-{size}-{scheme}.png", full_page=True
                            )
        browser.close()
    print("the page is as it should be")


if __name__ == "__main__":
    sys.exit(main())
