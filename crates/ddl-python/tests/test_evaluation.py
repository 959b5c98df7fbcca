"""Custom models on the benchmark."""

import json

import ddl_forecast as ddl
import numpy as np
import pytest
from conftest import run
from ddl_forecast import baselines


def constant_velocity(past):
    return past[:, None, -1:] + (past[:, -1] - past[:, -2])[:, None, None] * np.arange(1, 13)[None, None, :, None]


def test_scores_are_those_of_the_program(recordings, program, tmp_path):
    told = []
    results = ddl.evaluate(
        constant_velocity, folds=["zara1"], protocols=["fair", "single"], progress=lambda *now: told.append(now)
    )
    assert told[-1][0] == told[-1][1] and results.mean("min_ade") == pytest.approx(0.428, abs=5e-4)
    run(program, "evaluate", "--fold", "zara1", "--protocol", "fair", "--out", tmp_path, check=True)
    rows = json.loads((tmp_path / "report.json").read_text())["rows"]
    rows = [row for row in rows if "last step" in row["conditions"]["forecaster"]]
    theirs = [row["scores"] for row in rows]
    rules = [row["conditions"]["window_rule"] for row in rows]
    ours = next(row for row in results.rows if row["conditions"]["protocol"] == "fair")
    same = theirs[rules.index(ours["conditions"]["window_rule"])]
    assert ours["scores"]["min_fde"] == pytest.approx(same["min_fde"], rel=1e-12)
    assert "my model" in results.to_markdown("Mine")


def test_nothing_of_the_future_reaches_a_model(recordings):
    """Under `online` a model gets the rows up to the last observed frame, and no later ones."""
    calls = []

    def watching(past, seen):
        frames = seen["frame"]
        calls.append(frames[-1] if len(frames) else None)
        here = np.column_stack([seen["x"], seen["y"]])[frames == frames[-1]]
        assert all((np.abs(here - now).sum(axis=1) < 1e-12).any() for now in past[:, -1])
        seen["x"][:] = 0  # a copy: the next call must not notice
        return constant_velocity(past)

    results = ddl.evaluate(watching, folds=["hotel"], protocols=["online"])
    windows = ddl.windows("star", fold="hotel")
    assert calls == [window.frame for window in windows]
    assert results.rows[0]["conditions"]["protocol"] == "online"
    fair = ddl.evaluate(constant_velocity, folds=["hotel"])
    assert fair.mean("min_fde") == results.mean("min_fde", protocol="online")


def test_windows_of_a_fold_and_of_a_recording(tracks):
    windows = ddl.windows("simulated", fold="plaza")
    assert windows[0].past.shape[1:] == (8, 2) and windows[0].future.shape[1:] == (12, 2)
    training = ddl.windows("simulated", fold="plaza", part="training")
    assert {window.recording for window in training}.isdisjoint({window.recording for window in windows})
    # As many as `ddl data --convention simulated` counts: the crowds are the same.
    doorway = ddl.windows("simulated", fold="doorway", rule="complete")
    assert sum(len(window.ids) for window in doorway) == 2832
    own = ddl.windows(ddl.read(tracks))
    assert own and own[0].recording == "plaza" and len(own[0].ids) == len(own[0].past)


def test_all_forms_of_predictions_and_wrong_ones():
    def weighted(past):
        return np.repeat(constant_velocity(past), 2, axis=1), np.tile([0.75, 0.25], (len(past), 1))

    ways = [constant_velocity, lambda past: constant_velocity(past)[:, 0], weighted, baselines.constant_velocity]
    scores = [ddl.evaluate(way, convention="simulated", folds=["doorway"]).mean("min_ade") for way in ways]
    assert np.allclose(scores[:3], scores[0])
    # It sees positions as a forecaster does, which doubts those that people seldom make.
    assert abs(scores[3] - scores[0]) < 1e-3
    by_fold = ddl.evaluate(
        {"plaza": constant_velocity, "doorway": weighted}, convention="simulated", protocols=["single"]
    )
    assert {row["conditions"]["fold"] for row in by_fold.rows} == {"plaza", "doorway"}
    for wrong, words in [
        (lambda past: constant_velocity(past)[:, :, :5], "window 0"),
        (lambda past: np.full((len(past), 12, 2), np.nan), "window 0"),
        (lambda past: np.repeat(constant_velocity(past), 21, axis=1), "20"),
        (lambda past: np.ma.masked_all((len(past), 12, 2)), "window 0 of doorway, fair: paths has masked values"),
        (lambda past: (past, past, past), "window 0"),
    ]:
        with pytest.raises(ValueError, match=r".") as error:
            ddl.evaluate(wrong, convention="simulated", folds=["doorway"])
        assert words in str(error.value)
    with pytest.raises(ValueError, match="plaza"):
        ddl.evaluate(constant_velocity, convention="simulated", folds=["nowhere"])
    with pytest.raises(FileNotFoundError, match="recordings"):
        ddl.evaluate(constant_velocity, convention="star", folds=["eth"], data="/nowhere")


def test_a_forecaster_on_its_fold(recordings):
    told = []
    results = ddl.evaluate(ddl.Forecaster("hotel"), protocols=["single"], progress=lambda *now: told.append(now))
    rows = [row for row in results.rows if row["conditions"]["window_rule"] == "published"]
    assert rows[0]["scores"]["min_ade"] < 0.25 and told


def test_a_model_may_reuse_its_arrays():
    out = np.empty((500, 1, 12, 2))

    def reusing(past):
        out[: len(past)] = constant_velocity(past)
        return out[: len(past)]

    scores = [
        ddl.evaluate(way, convention="simulated", folds=["doorway"]).mean("min_fde")
        for way in (constant_velocity, reusing)
    ]
    assert scores[0] == scores[1]


def test_wrong_arguments_are_refused_at_once_and_models_are_distinguished():
    calls = []

    def model(past):
        calls.append(1)
        return constant_velocity(past)

    for change, words in [
        ({"protocols": ["fairr"]}, "protocols"),
        ({"protocols": "fair"}, "protocols"),
        ({"protocols": ["published"]}, "protocols"),
        ({"folds": ["plaza", "nowhere"]}, "nowhere"),
    ]:
        with pytest.raises(ValueError, match=words):
            ddl.evaluate(model, convention="simulated", **change)
    assert not calls
    with pytest.raises(ValueError, match="no model for the fold doorway"):
        ddl.evaluate({"plaza": model}, convention="simulated", folds=["plaza", "doorway"])
    with pytest.raises(ValueError, match="trained without star hotel"):
        ddl.evaluate({"eth": ddl.Forecaster("hotel")})
    with pytest.raises(ValueError, match="leave out name"):
        ddl.evaluate(ddl.Forecaster("hotel"), name="mine")
    with pytest.raises(ValueError, match="convention='star'"):
        ddl.evaluate(ddl.Forecaster("hotel"), convention="simulated")
    one = ddl.evaluate(constant_velocity, convention="simulated", folds=["plaza"], name="a")
    two = ddl.evaluate(lambda past: 0 * constant_velocity(past), convention="simulated", folds=["plaza"], name="b")
    with pytest.raises(ValueError, match="choose by name"):
        (one + two).mean()
    assert (one + two).mean(name="a") == one.mean() != (one + two).mean(name="b")
    other = ddl.evaluate(constant_velocity, convention="simulated", folds=["doorway"], name="b")
    with pytest.raises(ValueError, match="several models"):
        (one + other).mean()
    with pytest.raises(ValueError, match="no score"):
        one.mean("goal_fde")
