"""Soft-DTW compared with other Python packages: agreement of the values, and processor time on one core.

    pip install ddl-forecast tslearn aeon
    taskset -c 0 python soft_dtw.py

Prints a table. Times are medians of processor time over repeated calls. Every package has computed once before, so that
compilation does not count.
"""

import platform
import time
from collections.abc import Callable
from importlib.metadata import version

import ddl_forecast
import numpy as np
from aeon.distances import soft_dtw_distance
from ddl_forecast import soft_dtw as ours
from tslearn.metrics import SoftDTW, SquaredEuclidean, soft_dtw

SHAPES = [(8, 2), (20, 2), (64, 2), (256, 8)]
GAMMA = 1.0


def processor() -> str:
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
    return names[0] if names else platform.processor()


def median_time(call: Callable[[], object]) -> float:
    call()
    start, calls = time.perf_counter(), 0
    while time.perf_counter() - start < 0.05:
        call()
        calls += 1
    repeats = max(1, calls // 10)
    times = []
    for _ in range(25):
        begin = time.process_time()
        for _ in range(repeats):
            call()
        times.append((time.process_time() - begin) / repeats)
    return float(np.median(times))


def tslearn_gradient(x: np.ndarray, y: np.ndarray) -> tuple[float, np.ndarray]:
    distances = SquaredEuclidean(x, y)
    dtw = SoftDTW(distances, gamma=GAMMA)
    value = dtw.compute()
    return value, distances.jacobian_product(dtw.grad())


def main() -> None:
    ddl_forecast.set_num_threads(1)
    rng = np.random.default_rng(0)
    print(
        f"{processor()}, one core; ddl-forecast {ddl_forecast.__version__}, "
        f"tslearn {version('tslearn')}, aeon {version('aeon')}\n"
    )
    print("| shape | what | ddl-forecast | tslearn | aeon | times as fast as the faster |")
    print("|---|---|---|---|---|---|")
    for steps, components in SHAPES:
        x, y = (np.cumsum(rng.normal(0, 1.0, (steps, components)), axis=0) for _ in range(2))
        value, gradient = ours.value_and_gradient(x, y, GAMMA)
        ways = {
            "value": (
                lambda x=x, y=y: ours.value(x, y, GAMMA),
                lambda x=x, y=y: soft_dtw(x, y, GAMMA),
                lambda x=x, y=y: soft_dtw_distance(x.T, y.T, gamma=GAMMA),
            ),
            "value and gradient": (
                lambda x=x, y=y: ours.value_and_gradient(x, y, GAMMA),
                lambda x=x, y=y: tslearn_gradient(x, y),
                None,  # aeon has no gradient
            ),
        }
        for what, calls in ways.items():
            for call in calls:
                made = call() if call else (value, gradient)
                found, slope = made if isinstance(made, tuple) else (made, gradient)
                assert abs(found - value) <= 1e-9 * max(1.0, abs(value)), (what, found, value)
                assert np.allclose(slope, gradient, rtol=1e-9, atol=1e-9), what
            times = [median_time(call) if call else float("nan") for call in calls]
            shown = [f"{1e6 * one:.2f} us" if one == one else "-" for one in times]
            ratio = np.nanmin(times[1:]) / times[0]
            print(f"| {steps} x {steps} x {components} | {what} | {' | '.join(shown)} | {ratio:.0f} |")


if __name__ == "__main__":
    main()
