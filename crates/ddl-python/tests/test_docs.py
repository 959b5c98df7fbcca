"""Runs every example: docstrings, pages of the guide, and the notebook."""

import doctest
import importlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

STRICT = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports"]
STRICT += ["--disable-error-code=import-untyped", "--allow-untyped-calls"]
MODULES = [
    "ddl_forecast",
    "ddl_forecast._evaluation",
    "ddl_forecast._forecast",
    "ddl_forecast._forecaster",
    "ddl_forecast._live",
]
MODULES += [
    "ddl_forecast._recording",
    "ddl_forecast.baselines",
    "ddl_forecast.dynamics",
    "ddl_forecast.goals",
    "ddl_forecast.metrics",
]
MODULES += ["ddl_forecast.soft_dtw"]
CHECKOUT = Path(__file__).resolve().parents[3]
PAGES = ["docs/python.md", "docs/scale.md", "crates/ddl-python/README.md"]
#: The others are checked as examples, or have no types.
TYPED = ["docs/python.md"]


@pytest.mark.parametrize("module", MODULES)
def test_docstrings(module):
    result = doctest.testmod(importlib.import_module(module))
    assert result.failed == 0 and (result.attempted > 0 or module == "ddl_forecast._forecast")


def blocks(page):
    text = (CHECKOUT / page).read_text()
    return re.findall(r"```python\n(.*?)```", text, flags=re.S)


@pytest.mark.parametrize("page", PAGES)
def test_pages(page, tracks, tmp_path, request):
    """The blocks of a page run one after the other in a folder with tracks, and are typed."""
    if "evaluate(" in (CHECKOUT / page).read_text():
        request.getfixturevalue("recordings")
    shutil.copy(tracks, tmp_path / "tracks.csv")
    (tmp_path / "recordings").mkdir()
    for part in range(2):
        head = "".join(tracks.read_text().splitlines(keepends=True)[:150])
        (tmp_path / "recordings" / f"day{part}.csv").write_text(head)
    script = tmp_path / "page.py"
    script.write_text("\n".join(blocks(page)))
    environment = {
        **os.environ,
        "MPLBACKEND": "Agg",
        "RAYON_NUM_THREADS": "1",
        "PYTHONPATH": str(CHECKOUT / "crates/ddl-python/examples"),
    }
    ran = subprocess.run(
        [sys.executable, script],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    shown = [
        line.split("# ", 1)[1] for line in script.read_text().splitlines() if "->" in line and line.startswith("print(")
    ]
    for answer in shown:
        assert answer.split("-> ", 1)[1] in ran.stdout.splitlines(), answer
    pictures = os.environ.get("DDL_PAGE_PICTURES")
    if pictures:
        for picture in tmp_path.glob("*.png"):
            shutil.copy(picture, pictures)
    if page not in TYPED:
        return
    typed = subprocess.run([*STRICT, script], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
    assert typed.returncode == 0, typed.stdout


def test_examples_are_typed():
    examples = sorted((CHECKOUT / "crates/ddl-python/examples").glob("*.py"))
    typed = subprocess.run(
        [*STRICT, *examples], cwd=examples[0].parent, capture_output=True, text=True, timeout=300, check=False
    )
    assert typed.returncode == 0, typed.stdout


def test_other_formats(tracks, tmp_path):
    program = [sys.executable, CHECKOUT / "crates/ddl-python/examples/other_formats.py", tracks, tmp_path]
    ran = subprocess.run(program, capture_output=True, text=True, timeout=120, check=False)
    assert ran.returncode == 0, ran.stderr
    rows = (tmp_path / "sample_000.txt").read_text().splitlines()
    assert "(12, 2) (12, " in ran.stdout and len(rows) % 12 == 0 and len(rows[0].split()) == 4


def test_a_sampling_planner():
    tracks = CHECKOUT / "datasets/sample.csv"
    program = [sys.executable, "-W", "ignore", CHECKOUT / "crates/ddl-python/examples/mppi.py", tracks, "2.5", "8"]
    ran = subprocess.run(program, capture_output=True, text=True, timeout=300, check=False)
    assert ran.returncode == 0, ran.stderr
    away, closest = re.findall(r"([\d.]+) m from", ran.stdout)
    assert float(away) < 0.5 and float(closest) > 0.3


def test_a_torch_model():
    pytest.importorskip("torch")
    program = [sys.executable, CHECKOUT / "crates/ddl-python/examples/own_model_torch.py", "simulated", "3"]
    ran = subprocess.run(program, capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stderr
    assert "perceptron" in ran.stdout and float(ran.stdout.split()[-2].split("/")[0]) < 2


def test_the_notebook(tmp_path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(CHECKOUT / "crates/ddl-python/examples/gallery.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "clear the outputs before committing"
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in shown) == 3
    assert any("iframe" in output.get("data", {}).get("text/html", "") for output in shown)
