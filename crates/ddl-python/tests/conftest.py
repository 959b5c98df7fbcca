"""Shared fixtures: a simulated crowd, and real recordings if available."""

import os
import subprocess
import sys
from pathlib import Path

import ddl_forecast as ddl
import numpy as np
import pytest


@pytest.fixture(scope="session")
def forecaster() -> ddl.Forecaster:
    return ddl.Forecaster()


@pytest.fixture(scope="session")
def crossing() -> np.ndarray:
    """(25, 8, 2) pedestrians in all directions."""
    rng = np.random.default_rng(7)
    starts = rng.uniform(-8, 8, (25, 1, 2))
    angles, speeds = rng.uniform(0, 2 * np.pi, 25), rng.uniform(0.4, 1.8, 25)
    velocity = (speeds * np.array([np.cos(angles), np.sin(angles)])).T[:, None]
    wobble = rng.normal(0, 0.02, (25, 8, 2))
    return starts + velocity * 0.4 * np.arange(8)[None, :, None] + wobble


@pytest.fixture(scope="session")
def tracks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of tracks: one simulated recording of the program's own benchmark, as csv."""
    path = tmp_path_factory.mktemp("tracks") / "plaza.csv"
    crowd: dict[tuple[int, int], tuple[float, float]] = {}
    for window in ddl.windows("simulated", fold="plaza", rule="complete"):
        for i, one in enumerate(window.ids):
            for t in range(8):
                frame = window.frame - (7 - t) * window.frame_step
                crowd[frame, int(one)] = (window.past[i, t, 0], window.past[i, t, 1])
    rows = sorted(key for key in crowd if key[0] <= 600)  # a minute, 11 pedestrians at its end
    lines = [f"{frame},{one},{crowd[frame, one][0]!r},{crowd[frame, one][1]!r}" for frame, one in rows]
    path.write_text("frame,pedestrian,x,y\n" + "\n".join(lines).replace("np.float64(", "").replace(")", "") + "\n")
    return path


@pytest.fixture(scope="session")
def recordings() -> Path:
    """The folder of the STAR recordings; in CI their absence is an error."""
    folder = os.environ.get("DDL_DATASETS")
    if folder is None:
        if os.environ.get("CI"):
            pytest.fail("set DDL_DATASETS to the folder of the recordings")
        pytest.skip("set DDL_DATASETS to the folder of the recordings")
    return Path(folder)


@pytest.fixture(scope="session")
def program() -> str:
    """The console script of this environment."""
    return str(Path(sys.executable).with_name("ddl"))


def run(*arguments: object, **options: object) -> subprocess.CompletedProcess[str]:
    words = [str(one) for one in arguments]
    return subprocess.run(  # type: ignore[call-overload,no-any-return]
        words, capture_output=True, text=True, timeout=120, **options
    )
