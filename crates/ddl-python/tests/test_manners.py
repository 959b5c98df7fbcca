"""How the package behaves: lock, threads, interruption, memory, forks, the console script, the import."""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import run

import ddl_forecast as ddl
from ddl_forecast import soft_dtw


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
    forecaster.forecast(crowd(300))
    took = time.perf_counter() - begin
    stop.set()
    ticker.join()
    during = [at for at in ticks if begin <= at <= begin + took]
    assert took > 0.05 and len(during) > 5, (took, len(during))
    assert max(np.diff(during)) < max(0.1, took / 3)


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


LONG = """
import numpy as np, time, sys
import ddl_forecast as ddl
rng = np.random.default_rng(0)
scenes = [rng.uniform(0, 20, (30, 1, 2)) + rng.normal(0, .5, (30, 1, 2)) * .4 * np.arange(8)[None, :, None] for _ in range(2000)]
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


def test_a_forked_child_forecasts(forecaster, crossing):
    expected = forecaster.forecast(crossing).paths
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(write, pickle.dumps(forecaster.forecast(crossing).paths)[:1] + str(float(forecaster.forecast(crossing).paths.sum())).encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as answer:
        text = answer.read()
    os.waitpid(child, 0)
    assert float(text[1:]) == float(expected.sum())


def test_contiguous_arrays_are_not_copied():
    x = np.zeros((200_000, 2))
    y = np.zeros((1, 2))
    soft_dtw.value(x, y)
    begin = time.perf_counter()
    for _ in range(5):
        soft_dtw.value(x, y)
    plain = time.perf_counter() - begin
    turned = np.asfortranarray(x)
    begin = time.perf_counter()
    for _ in range(5):
        soft_dtw.value(turned, y)
    assert plain < 1.5 * (time.perf_counter() - begin)


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
    piped = subprocess.run(["sh", "-c", f"{program} forecast {tracks} | head -n 2"], capture_output=True, text=True, timeout=60, check=False)
    assert len(piped.stdout.splitlines()) == 2 and not piped.stderr
    told = run(program, "train", "--data", tracks, "--out", tmp_path / "run")
    assert told.returncode == 1 and "libtorch" in told.stderr
    watching = subprocess.Popen([program, "forecast", "-", "--fps", "2.5"], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL)
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
