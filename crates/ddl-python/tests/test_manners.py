"""Behaviour of the package: GIL, threads, interruption, memory, forks, console script, import time."""

import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

import ddl_forecast as ddl
import numpy as np
import pytest
from conftest import run
from ddl_forecast import metrics, soft_dtw


def crowd(count):
    rng = np.random.default_rng(0)
    side = 3 * np.sqrt(count)
    starts = rng.uniform(0, side, (count, 1, 2))
    return starts + rng.normal(0, 0.5, (count, 1, 2)) * 0.4 * np.arange(8)[None, :, None]


def test_other_threads_run_while_a_forecast_is_made(forecaster):
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.002)

    ticker = threading.Thread(target=tick)
    ticker.start()
    begin = time.perf_counter()
    forecaster.forecast(crowd(3000))
    end = time.perf_counter()
    stop.set()
    ticker.join()
    # A call that held the interpreter would be one pause from its begin to its end, on a machine of any speed.
    pauses = np.diff([begin, *(at for at in ticks if begin <= at <= end), end])
    assert max(pauses) < (end - begin) / 2, (end - begin, len(pauses), max(pauses))


def test_threads_get_the_same_bits(forecaster, crossing):
    expected = forecaster.forecast(crossing).paths
    made = [None] * 6

    def one(at):
        made[at] = forecaster.forecast(crossing).paths

    threads = [threading.Thread(target=one, args=(at,)) for at in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(paths, expected) for paths in made)
    ddl.set_num_threads(1)
    assert np.array_equal(forecaster.forecast(crossing).paths, expected)
    ddl.set_num_threads(os.cpu_count())
    with pytest.raises(ValueError, match="at least 1"):
        ddl.set_num_threads(0)
    with pytest.raises(ValueError, match="1025 threads are more than 1024"):
        ddl.set_num_threads(1025)


LONG = """
import numpy as np, time, sys
import ddl_forecast as ddl
rng = np.random.default_rng(0)
times = .4 * np.arange(8)[None, :, None]
scenes = [rng.uniform(0, 20, (30, 1, 2)) + rng.normal(0, .5, (30, 1, 2)) * times for _ in range(2000)]
forecaster = ddl.Forecaster()
print("begun", flush=True)
try:
    forecaster.forecast_all(scenes)
except KeyboardInterrupt:
    print("stopped", time.time(), flush=True)
"""


def test_ctrl_c_ends_a_long_call():
    program = subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True)
    assert program.stdout.readline().strip() == "begun"
    time.sleep(0.5)
    asked = time.time()
    program.send_signal(signal.SIGINT)
    word, at = program.stdout.readline().split()
    assert word == "stopped" and float(at) - asked < 0.2, float(at) - asked
    program.wait(10)
    program.stdout.close()


def test_a_forked_child_computes(forecaster, crossing):
    """A forked child does not inherit threads, so everything that uses several threads is tested."""
    truth = np.repeat(crossing[None, :, -1:], 2, axis=0)[:, :, 0][:, :, None] + np.zeros((2, 25, 12, 2))
    paths = [truth[0][:, None], truth[1][:, None]]

    def everything():
        scores = metrics.scores(paths, list(truth), [crossing, crossing])
        report = ddl.evaluate(
            lambda past: past[:, -1:, None] + np.zeros((len(past), 1, 12, 2)), convention="simulated", folds=["doorway"]
        )
        walks = [np.cumsum(crossing[i], axis=0) for i in range(25)]
        nearest = soft_dtw.SearchIndex(walks).nearest(walks[0], 3)[1]
        return f"{forecaster.forecast(crossing).paths.sum()} {scores['min_ade']} {report.to_markdown()} {nearest}"

    expected = everything()
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            signal.alarm(60)
            with os.fdopen(write, "w") as answer:
                answer.write(everything())
        finally:
            os._exit(0)
    os.close(write)
    with os.fdopen(read) as answer:
        text = answer.read()
    os.waitpid(child, 0)
    assert text == expected


def test_ctrl_c_while_a_frame_is_forecast_closes_the_watch():
    """An interrupted `with` block writes the memory, also on one thread."""
    script = """
import signal, sys, time, os, threading
import numpy as np
import ddl_forecast as ddl
ddl.set_num_threads(int(sys.argv[2]))
rng = np.random.default_rng(0)
starts, steps = rng.uniform(0, 40, (900, 2)), rng.normal(0, .4, (900, 2))
threading.Timer(3.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    with ddl.Live(ddl.Forecaster(), fps=2.5, memory=sys.argv[1]) as live:
        for frame in range(1000):
            live.observe(frame, range(900), starts + frame * steps)
except KeyboardInterrupt:
    print("closed", os.path.exists(sys.argv[1]))
"""
    for threads in ("1", "2"):
        with tempfile.TemporaryDirectory() as folder:
            ran = run(sys.executable, "-c", script, f"{folder}/place.memory", threads)
            assert ran.stdout.split() == ["closed", "True"], ran.stderr


def test_contiguous_arrays_are_not_copied():
    """A copy of the long one would be 64 MB more at the peak."""
    script = """
import re, sys
import numpy as np
from ddl_forecast import soft_dtw
peak = lambda: int(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1])
x, y = np.ones((4_000_000, 2), order="F" if sys.argv[1] == "turned" else "C"), np.zeros((1, 2))
before = peak()
soft_dtw.value(x, y)
print((peak() - before) // 1024)
"""
    plain, turned = (int(run(sys.executable, "-c", script, kind, check=True).stdout) for kind in ("plain", "turned"))
    assert turned - plain > 50, (plain, turned)


def test_the_import_is_quick():
    script = "import time, numpy; t = time.perf_counter(); import ddl_forecast; print(time.perf_counter() - t)"
    times = [float(run(sys.executable, "-c", script, check=True).stdout) for _ in range(3)]
    assert min(times) < 0.08, times
    modules = run(sys.executable, "-c", "import ddl_forecast, sys; print(*sys.modules)", check=True).stdout.split()
    assert {"torch", "pandas", "matplotlib", "scipy"}.isdisjoint(modules)


def test_the_console_script_is_the_program(program, tracks, tmp_path):
    assert run(program, "--version", check=True).stdout.startswith("ddl ")
    assert run(sys.executable, "-m", "ddl_forecast", "info", check=True).stdout
    wrong = run(program, "forecast", tmp_path / "nowhere.csv")
    assert wrong.returncode == 1 and "nowhere.csv" in wrong.stderr
    assert run(program, "forecats").returncode == 2
    page = run(program, "view", tracks, "--no-open", "--output", tmp_path / "page.html", check=True)
    assert page.stdout and (tmp_path / "page.html").stat().st_size > 10_000
    piped = subprocess.run(
        ["sh", "-c", f"{program} forecast {tracks} --frame-step 10 | head -n 2"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert len(piped.stdout.splitlines()) == 2 and not piped.stderr
    told = run(program, "train", "--data", tracks, "--out", tmp_path / "run")
    assert told.returncode == 1 and "libtorch" in told.stderr
    watching = subprocess.Popen(
        [program, "forecast", "-", "--fps", "2.5"], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    time.sleep(0.5)
    watching.send_signal(signal.SIGINT)
    assert watching.wait(5) != 0
    watching.stdin.close()


def test_the_program_built_by_cargo_gives_the_same_bits(program, tracks):
    built = os.environ.get("DDL_PROGRAM")
    if built is None:
        pytest.skip("DDL_PROGRAM does not name a program built by cargo")
    arguments = ("forecast", tracks, "--format", "jsonl", "--last", "--certificate")
    assert run(built, *arguments, check=True).stdout == run(program, *arguments, check=True).stdout
