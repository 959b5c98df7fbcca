"""Opens the page of `cargo xtask web` in a browser and compares it with the program.

    check_web.py FOLDER --browser PROGRAM --screenshots FOLDER

FOLDER holds the page, `index.html`, which is opened from the file system. The program is target/debug/ddl. Real tracks
are those of $DDL_DATASETS or datasets/eth_ucy; without them only simulated ones are compared.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

from check_page import HERE, NARROW, WIDE, Opened, decoded, wait_for
from playwright.sync_api import sync_playwright

ROOT = HERE.parent.parent
PROGRAM = ROOT / "target/debug/ddl"
SAMPLE = ROOT / "datasets/sample.csv"
TOLERANCE = 1e-5  # m
ROUNDED = 0.000_51  # m, in the player
# Joint futures are drawn: where a number lies on the edge of a draw, the last bit of a weight decides, and vectors of
# another length round it otherwise. So many of a hundred moments may have other draws.
REDRAWN = 0.05
# The bars for a busy machine.
FIRST, JOINT = 10, 300  # s until the first forecast of 12 people, ms of 20 joint futures of 25
EVERY = "0.8"  # s, so that a recording of minutes is forecast in seconds
# What the program says about its output, and of motions, of which the page may play fewer.
OF_OUTPUT = ("lines; --output", "MiB, because", "are unlike the training motions")


class OpenedWeb(Opened):
    """The page, in which nothing may be requested but itself, its worker and the player that it makes."""

    def __init__(self, browser, path, viewport=WIDE, scheme="light"):
        self.start = time.monotonic()
        super().__init__(browser, path, viewport, scheme)

    def __exit__(self, kind, *rest):
        own = ("request: blob:", "request: about:srcdoc")
        self.faults = [fault for fault in self.faults if not fault.startswith(own)]
        super().__exit__(kind, *rest)

    def show(self, act):
        """Waits for the next answer, and returns the seconds it took."""
        start, before = time.monotonic(), self.page.evaluate("document.body.dataset.shown ?? '0'")
        act()
        wait_for(self.page, "(before) => (document.body.dataset.shown ?? '0') !== before", before, 120)
        return time.monotonic() - start

    def saved(self, selector):
        with self.page.expect_download() as download:
            self.page.click(selector)
        return pathlib.Path(download.value.path()).read_text()

    def player(self):
        return next(frame for frame in self.page.frames if frame.parent_frame)


def program(*arguments, folder, fails=False):
    done = subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, timeout=300)
    assert (done.returncode != 0) == fails, done.stderr
    return done


def in_words_of_browsers(text):
    """Settings as the browser writes them: frameStep for --frame-step."""
    return re.sub(r"--([a-z-]+)", lambda found: re.sub(r"-(.)", lambda at: at[1].upper(), found[1]), text)


def by_moment(text):
    lines = [json.loads(line) for line in text.splitlines()]
    return {(line["observed_until"], line.get("pedestrian")): line for line in lines}


def compare(found, expected, where):
    """The largest difference of two values of JSON, which must be alike in everything but rounding."""
    if isinstance(expected, dict):
        assert found.keys() == expected.keys(), where
        return max((compare(found[key], value, (*where, key)) for key, value in expected.items()), default=0)
    if isinstance(expected, list):
        assert len(found) == len(expected), where
        return max((compare(a, b, (*where, i)) for i, (a, b) in enumerate(zip(found, expected))), default=0)
    if isinstance(expected, float):
        assert abs(found - expected) <= TOLERANCE, (where, found, expected)
        return abs(found - expected)
    assert found == expected, (where, found, expected)
    return 0


def difference(found, expected, where):
    """The largest difference of two forecasts, or where they are more than rounding apart."""
    try:
        return float(compare(found, expected, where))
    except AssertionError as error:
        return str(error)


def check_file(opened, file, joint):
    """Every number of the page, the player and the notes agree with the program."""
    opened.page.fill("[name=every]", EVERY)
    opened.page.set_checked("#joint", joint)
    seconds = opened.show(lambda: opened.page.set_input_files("#file", file))
    flags = ["--every", EVERY, *(["--joint"] if joint else [])]
    done = program("forecast", file.name, "--format", "jsonl", *flags, folder=file.parent)
    expected, found = by_moment(done.stdout), by_moment(opened.saved("#save-lines"))
    assert found and found.keys() <= expected.keys()
    differences = [difference(line, expected[key], key) for key, line in found.items()]
    agreeing = [one for one in differences if isinstance(one, float)]
    redrawn = [one for one in differences if not isinstance(one, float)]
    assert len(redrawn) <= (REDRAWN * len(found) if joint else 0), redrawn[0]
    shown = opened.page.locator("#notes li").all_inner_texts()
    shown, told = (
        [line for line in lines if not any(words in line for words in OF_OUTPUT)]
        for lines in (shown, in_words_of_browsers(done.stderr).splitlines())
    )
    assert shown == told
    data = json.loads(opened.player().evaluate("document.getElementById('moments-json').textContent"))
    for moment in decoded(data):
        for at, who in enumerate(moment["pedestrians"]):
            line = found[moment["frame"], None if joint else who["pedestrian"]]
            paths = [one["paths"][at] for one in line["futures"]] if joint else line["hypotheses"]
            for shown, path in zip(who["hypotheses"], paths, strict=True):
                for p, q in zip(shown["positions"], path["positions"], strict=True):
                    assert max(abs(a - b) for a, b in zip(p, q)) <= ROUNDED, (moment["frame"], who["pedestrian"])
    words = "joint futures" if joint else "hypotheses"
    print(
        f"{file.name}: {words}: {len(agreeing)} of {len(found)} within {max(agreeing):.1e} m of the program; "
        f"shown after {seconds:.2f} s"
    )


def check_errors(opened, folder):
    """A file that cannot be read shows the error of the program, and the next one is shown again."""
    files = {
        "word.csv": "frame,pedestrian,x,y\n0,1,0.0,left\n",
        "nothing.csv": "",
        "packed.csv": "PK\x03\x04",
        "picture.csv": "frame,pedestrian,x_px,y_px\n0,1,100,200\n1,1,110,200\n",
    }
    for name, text in files.items():
        (folder / name).write_text(text)
        opened.page.set_input_files("#file", folder / name)
        wait_for(opened.page, "!document.getElementById('error').hidden")
        assert not opened.page.locator("#player").is_visible()
        expected = in_words_of_browsers(program("forecast", name, folder=folder, fails=True).stderr.strip())
        assert opened.text("#error") == expected, (opened.text("#error"), expected)
    (folder / "log.mcap").write_bytes(b"\x89MCAP0\r\n")
    opened.page.set_input_files("#file", folder / "log.mcap")
    wait_for(opened.page, "document.getElementById('error').textContent.includes('an MCAP file is not read here')")
    assert opened.show(lambda: opened.page.click("#example"))
    assert not opened.page.locator("#error").is_visible() and opened.page.locator("#player").is_visible()


def check_trap(opened):
    """After a trap the page says so, and goes on with a new worker."""
    trap = "\nwasm_bindgen.view = () => { throw new WebAssembly.RuntimeError('unreachable'); };"
    opened.page.evaluate(
        """(trap) => {
            const text = embedded("worker");
            worker.terminate();
            byId("worker").textContent += trap;
            worker = start();
            byId("worker").textContent = text;
        }""",
        trap,
    )
    opened.page.click("#example")
    wait_for(opened.page, "!document.getElementById('error').hidden")
    assert "too large for a tab, or the forecaster has a defect (unreachable)" in opened.text("#error")
    assert opened.show(lambda: opened.page.click("#example"))
    assert not opened.page.locator("#error").is_visible()


def check_options(opened, folder):
    """An option is that of the program, and a wrong one is an error."""
    opened.page.evaluate("document.querySelector('details').open = true")
    opened.show(lambda: (opened.page.fill("[name=fps]", "5"), opened.page.press("[name=fps]", "Tab")))
    expected = by_moment(program("forecast", SAMPLE, "--fps", "5", "--format", "jsonl", folder=folder).stdout)
    for key, line in by_moment(opened.saved("#save-lines")).items():
        compare(line, expected[key], key)
    opened.page.fill("[name=dt]", "0.1")
    opened.page.press("[name=dt]", "Tab")
    wait_for(opened.page, "!document.getElementById('error').hidden")
    assert "one of fps, dt and frameStep" in opened.text("#error")


def check_memory(opened):
    """With the memory of the place later forecasts change, and the place is drawn."""
    opened.show(lambda: opened.page.click("#example"))
    before = by_moment(opened.saved("#save-lines"))
    opened.show(lambda: opened.page.check("#memory"))
    after = by_moment(opened.saved("#save-lines"))
    changed = [key for key in before if before[key]["hypotheses"] != after[key]["hypotheses"]]
    assert before.keys() == after.keys() and changed and min(key[0] for key in changed) > min(key[0] for key in before)
    assert opened.page.locator("#place > svg").is_visible() and opened.saved("#save-place").startswith("<?xml")


def check_closed(browser, page):
    """The page may not send anything, wherever to."""
    with OpenedWeb(browser, page) as opened:
        tries = """() => Promise.all([
            fetch("https://example.org/").then(() => "sent", () => "refused"),
            new Promise((done) => { const picture = new Image(); picture.onload = () => done("sent");
                picture.onerror = () => done("refused"); picture.src = "https://example.org/picture.png"; }),
        ])"""
        assert opened.page.evaluate(tries) == ["refused", "refused"]
        refused = [fault for fault in opened.faults if "Content Security Policy" in fault]
        assert len(refused) >= 2, opened.faults
        # The browser reports what it refused.
        opened.faults = [fault for fault in opened.faults if "example.org" not in fault]


def dozen(folder):
    """Twelve people over 9 steps."""
    rows = [f"{t},{i},{0.5 * t * (-1) ** i + i},{1.1 * i}" for t in range(9) for i in range(12)]
    file = folder / "dozen.csv"
    file.write_text("\n".join(["frame,pedestrian,x,y", *rows]) + "\n")
    return file


MEASURE = """
(async () => {
  while (!ready) await new Promise((done) => setTimeout(done, 20));
  await ready;
  const place = new wasm_bindgen.Live({ joint: true });
  const [ids, times] = [Float64Array.from({ length: 25 }, (_, i) => i), []];
  for (let step = 0; step < 40; step += 1) {
    const at = (i) => [(i % 5) * 2 + 0.5 * step * (-1) ** i, Math.floor(i / 5) * 1.5];
    const start = performance.now();
    place.observe(0.4 * step, ids, Float64Array.from([...ids].flatMap(at)));
    times.push(performance.now() - start);
  }
  postMessage({ times });
})();
"""


def measure(opened):
    """Milliseconds of joint futures of 25 people in the browser, in a worker like that of the page."""
    times = opened.page.evaluate(
        """(more) => new Promise((done) => {
            const worker = new Worker(URL.createObjectURL(new Blob([embedded("worker") + more])));
            worker.onmessage = ({ data }) => data.times && done(data.times);
            worker.postMessage({ packed: embedded("forecaster").trim() });
        })""",
        MEASURE,
    )
    times = sorted(times[8:])
    median = times[len(times) // 2]
    print(f"25 people x 20 joint futures: median {median:.0f} ms, least {times[0]:.0f} ms")
    assert median <= JOINT


def check_looks(browser, page, screenshots):
    for name, viewport in (("wide", WIDE), ("narrow", NARROW)):
        for scheme in ("light", "dark"):
            with OpenedWeb(browser, page, viewport, scheme) as opened:
                opened.page.screenshot(path=screenshots / f"web-opened-{name}-{scheme}.png", full_page=True)
                opened.show(lambda opened=opened: opened.page.click("#example"))
                opened.show(lambda opened=opened: opened.page.check("#joint"))
                opened.page.wait_for_timeout(300)
                opened.page.screenshot(path=screenshots / f"web-{name}-{scheme}.png", full_page=True)
                for frame in (opened.page, opened.player()):
                    spare = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
                    assert frame.evaluate(spare) <= 0, (name, scheme)
                    found = frame.evaluate((HERE / "contrast.js").read_text())
                    assert found["seen"] > 15 and not found["faults"], (name, scheme, found)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--browser", required=True)
    parser.add_argument("--screenshots", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    page = arguments.folder.resolve() / "index.html"
    arguments.screenshots.mkdir(parents=True, exist_ok=True)
    files = [SAMPLE, ROOT / "tests/golden/tracks.csv"]
    recordings = pathlib.Path(os.environ.get("DDL_DATASETS") or ROOT / "datasets/eth_ucy")
    if recordings.is_dir():
        files.append(recordings / "zara02.csv")
    else:
        assert "CI" not in os.environ, f"no recordings in {recordings}"
        print(f"no recordings in {recordings}: the page is compared on simulated tracks alone")
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        browser = playwright.chromium.launch(executable_path=arguments.browser, args=["--no-sandbox"])
        with OpenedWeb(browser, page) as opened:
            opened.show(lambda: opened.page.set_input_files("#file", dozen(folder)))
            first = time.monotonic() - opened.start
            print(f"first forecasts of 12 people {first:.2f} s after opening")
            assert first <= FIRST
            measure(opened)
        for file in files:
            for joint in (False, True):
                with OpenedWeb(browser, page) as opened:
                    check_file(opened, file, joint)
        with OpenedWeb(browser, page) as opened:
            check_errors(opened, folder)
            check_trap(opened)
            check_memory(opened)
        with OpenedWeb(browser, page) as opened:
            opened.show(lambda: opened.page.click("#example"))
            check_options(opened, folder)
        check_closed(browser, page)
        check_looks(browser, page, arguments.screenshots)
        browser.close()
    print("the page is as it should be")


if __name__ == "__main__":
    main()
