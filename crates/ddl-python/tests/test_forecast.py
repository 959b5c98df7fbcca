"""Forecasts of arrays, recordings and live frames."""

import itertools
import json
import pickle
import threading
import warnings

import ddl_forecast as ddl
import numpy as np
import pytest
from conftest import run
from ddl_forecast import baselines


def test_shapes_and_laws(forecaster, crossing):
    forecast = forecaster.forecast(crossing, certificates=True)
    assert forecast.paths.shape == (25, 20, 12, 2)
    assert forecast.weights.shape == (25, 20) and np.allclose(forecast.weights.sum(axis=1), 1)
    assert forecast.goals.shape == (25, 20, 2) and forecast.familiarity.shape == (25,)
    assert forecast.valid.all() and forecast.certified.all()
    assert (np.diff(forecast.certificates.potentials, axis=2) <= 0).all()
    assert (forecast.certificates.min_eigenvalue > 0).all()
    assert forecast.most_likely().shape == forecast.mean().shape == (25, 12, 2)
    small, large = forecast.regions(0.5), forecast.regions(0.9)
    path, scene = (np.nan_to_num(forecast.regions(0.9, of=of)) for of in ("path", "scene"))
    assert (np.nan_to_num(large) < path).any() and (np.nan_to_num(large) <= path).all() and (path <= scene).all()
    with pytest.raises(ValueError, match="step, path or scene"):
        forecast.regions(of="crowd")  # type: ignore[arg-type]
    discs = ~np.isnan(small)
    assert discs.any(axis=1).all() and (large[discs] > small[discs]).all()
    one = forecaster.forecast(crossing, samples=1)
    assert one.paths.shape == (25, 1, 12, 2) and (one.weights == 1).all()


def test_unobserved_pedestrians_are_nan_and_do_not_change_others(forecaster, crossing):
    alone = forecaster.forecast(crossing[:3])
    absent = np.full((1, 8, 2), np.nan)
    gone = crossing[3:4].copy()
    gone[0, -1] = np.nan
    forecast = forecaster.forecast(np.concatenate([crossing[:2], absent, crossing[2:3], gone]))
    assert forecast.valid.tolist() == [True, True, False, True, False]
    assert np.isnan(forecast.paths[~forecast.valid]).all() and np.isnan(forecast.familiarity[2])
    assert np.array_equal(forecast.paths[forecast.valid], alone.paths)
    assert np.isnan(forecast.regions(0.9)[2]).all()
    empty = forecaster.forecast(np.empty((0, 8, 2)))
    assert len(empty) == 0 and empty.paths.shape == (0, 20, 12, 2)


def test_neighbours_influence_the_forecast_and_are_not_forecast(forecaster, crossing):
    both = forecaster.forecast(crossing[:5])
    first = forecaster.forecast(crossing[:2], neighbours=crossing[2:5])
    assert np.array_equal(first.paths, both.paths[:2])
    assert len(first) == 2


@pytest.mark.parametrize(
    ("past", "words"),
    [
        (np.zeros((3, 7, 2)), "(n, 8, 2)"),
        (np.zeros((8, 2)), "(n, 8, 2)"),
        (np.full((2, 8, 2), np.inf), "past[0, 0] is [inf, inf]"),
        (np.where(np.arange(32).reshape(2, 8, 2) == 21, np.nan, 1.0), "past[1, 2]"),
        (np.full((2, 8, 2), 1e9), "1e7 m"),
        ([["a"]], "array of numbers"),
    ],
)
def test_wrong_arrays_are_named(forecaster, past, words):
    with pytest.raises(ValueError, match="past") as error:
        forecaster.forecast(past)
    assert words in str(error.value)


def test_wrong_models_and_samples(tmp_path, forecaster, crossing):
    with pytest.raises(FileNotFoundError, match="hotel"):
        ddl.Forecaster("corridor")
    broken = tmp_path / "broken.ddl"
    broken.write_bytes(b"\x10\0\0\0\0\0\0\0{}")
    with pytest.raises(ValueError, match=r"broken\.ddl"):
        ddl.Forecaster(broken)
    with pytest.raises(ValueError, match="samples must be 20"):
        forecaster.forecast(crossing, samples=7)
    with pytest.raises(ValueError, match="probability"):
        forecaster.forecast(crossing).regions(1.5)
    with pytest.raises(ValueError, match="no regions"):
        baselines.constant_velocity(crossing).regions()


def test_every_builtin_model_forecasts(crossing):
    names = ("world", "eth", "hotel", "univ", "zara1", "zara2")
    ends = [ddl.Forecaster(name).forecast(crossing).paths[0, 0, -1] for name in names]
    assert len({tuple(end) for end in ends}) == len(names)


def test_pickled_and_many_scenes(forecaster, crossing):
    again = pickle.loads(pickle.dumps(forecaster))
    forecast = again.forecast(crossing)
    assert np.array_equal(forecast.paths, forecaster.forecast(crossing).paths)
    kept = pickle.loads(pickle.dumps(forecast))
    assert np.array_equal(kept.regions(0.9), forecast.regions(0.9), equal_nan=True)
    scenes = forecaster.forecast_all([crossing[:4], crossing[4:9], crossing])
    for scene, past in zip(scenes, (crossing[:4], crossing[4:9], crossing), strict=True):
        assert np.array_equal(scene.paths, forecaster.forecast(past).paths)


def test_bits_of_the_program(forecaster, tracks, program):
    lines = run(
        program, "forecast", tracks, "--format", "jsonl", "--last", "--region", "0.9", check=True
    ).stdout.splitlines()
    told = {line["pedestrian"]: line for line in map(json.loads, lines)}
    recording = ddl.read(tracks)
    (forecast,) = forecaster.forecast_recording(recording, last=True)
    assert set(told) == set(forecast.ids.tolist()) and len(told) > 3
    for i, one in enumerate(forecast.ids.tolist()):
        line = told[one]
        assert [h["positions"] for h in line["hypotheses"]] == forecast.paths[i].tolist()
        assert [h["weight"] for h in line["hypotheses"]] == forecast.weights[i].tolist()
        assert [h["goal"] for h in line["hypotheses"]] == forecast.goals[i].tolist()
        assert line["familiarity"] == forecast.familiarity[i] and line["frames"] == forecast.frames.tolist()
        for name in ("unseen", "age", "uncertainty"):
            assert line[name] == getattr(forecast, name)[i], name
        discs = [sorted(disc[2] for disc in step) for step in line["regions"][0]["discs"]]
        radii = forecast.regions(0.9)[i]
        assert discs == [sorted(radius for radius in step if not np.isnan(radius)) for step in radii.T]


def test_tables_of_numpy_pandas_and_polars(forecaster, tracks, program, tmp_path):
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    made = tmp_path / "made.csv"
    run(program, "forecast", tracks, "--output", made, check=True)
    frame = pandas.read_csv(tracks, float_precision="round_trip")  # otherwise the last digit differs
    columns = forecaster.forecast_table(frame.frame, frame.pedestrian, frame.x, frame.y)
    ours, theirs = pandas.DataFrame(columns), pandas.read_csv(made)
    assert len(ours) == len(theirs)
    for name in ("observed_until", "pedestrian", "hypothesis", "frame"):
        assert (ours[name] == theirs[name]).all(), name
    for name in ("x", "y", "goal_x", "goal_y"):
        assert np.allclose(ours[name], theirs[name], atol=6e-5), name
    table = polars.read_csv(tracks)
    again = forecaster.forecast_table(table["frame"], table["pedestrian"], table["x"], table["y"])
    assert all(np.array_equal(columns[name], again[name]) for name in columns)
    words = forecaster.forecast_table(
        table["frame"], ["p" + str(one) for one in table["pedestrian"]], table["x"], table["y"]
    )
    assert words["pedestrian"].dtype.kind == "U" and np.allclose(np.sort(words["x"]), np.sort(columns["x"]), atol=1e-3)


def test_live_has_the_bits_of_the_recording(forecaster, tracks, tmp_path):
    recording = ddl.read(tracks)
    frame, one, x, y = recording.frame, recording.id, recording.x, recording.y
    expected = {forecast.frame: forecast for forecast in forecaster.forecast_recording(recording)}
    memory = tmp_path / "plaza.memory"
    with ddl.Live(forecaster, fps=2.5 * recording.frame_step) as live:
        for at in np.unique(frame):
            now = frame == at
            forecast = live.observe(at, one[now], np.column_stack([x[now], y[now]]))
            if forecast is None:
                assert at not in expected
                continue
            assert np.array_equal(forecast.paths, expected[at].paths) and np.array_equal(forecast.ids, expected[at].ids)
    with ddl.Live(forecaster, fps=2.5 * recording.frame_step, memory=memory) as live:
        for at in np.unique(frame):
            now = frame == at
            forecast = live.observe(at, one[now], np.column_stack([x[now], y[now]]))
        assert live.remembered > 20
    assert memory.is_file()
    assert not np.array_equal(forecast.paths, expected[frame[-1]].paths)
    with ddl.Live(forecaster, fps=2.5 * recording.frame_step, memory=memory) as live:
        assert live.remembered > 20
        with pytest.raises(ValueError, match="another process"):
            ddl.Live(forecaster, fps=2.5 * recording.frame_step, memory=memory)


def test_live_refuses_wrong_frames_and_continues(forecaster):
    live = ddl.Live(forecaster, fps=2.5)
    for frame in range(7):
        assert live.observe(frame, ["a", "b"], [[0.4 * frame, 0], [5, 0.4 * frame]]) is not None
    with pytest.raises(ValueError, match="after"):
        live.observe(3, ["a"], [[0, 0]])
    with pytest.raises(ValueError, match="finite"):
        live.observe(7, ["a"], [[np.nan, 0]])
    with pytest.raises(ValueError, match="one position for each id"):
        live.observe(7, ["a", "b"], [[0, 0]])
    forecast = live.observe(7, ["a", "b"], [[2.8, 0], [5, 2.8]])
    assert forecast is not None and forecast.ids.tolist() == ["a", "b"]
    live.clear()
    assert live.observe(0, ["a"], [[0, 0]]).unseen.tolist() == [7]
    with pytest.raises(ValueError, match=r"\(n, 2\)"):
        live.observe(1, ["a", "b", "c"], [[0, 1, 2], [3, 4, 5]])
    with pytest.raises(ValueError, match="neither"):
        live.observe(1, [("a", 1)], [[0, 0]])
    with pytest.raises(TypeError):
        live.observe(1.5, ["a"], [[0, 0]])


def test_numbers_and_words_are_different_pedestrians(forecaster):
    live = ddl.Live(forecaster, fps=2.5)
    for frame in range(10):
        ids = [0, "ann"] if frame % 2 else ["ann", 0]
        places = {0: [0.5 * frame, 0.0], "ann": [9 - 0.5 * frame, 4.0]}
        forecast = live.observe(frame, ids, [places[one] for one in ids])
    found = {one: forecast.past[i, -1].tolist() for i, one in enumerate(forecast.ids.tolist())}
    assert found == {0: [4.5, 0.0], "ann": [4.5, 4.0]}
    assert len(ddl.Live(forecaster, fps=2.5).observe(0, [], []) or []) == 0


def test_words_of_absent_pedestrians_are_forgotten(forecaster, monkeypatch):
    monkeypatch.setattr("ddl_forecast._live.MOST_WORDS", 20)
    live = ddl.Live(forecaster, fps=2.5, max_age=1)
    for frame in range(60):
        forecast = live.observe(frame, ["stays", f"passes {frame}"], [[0.4 * frame, 0.0], [5.0, 5.0]])
    # Who passed within a second is carried on.
    assert len(live._words) <= 20 and forecast.ids.tolist() == ["stays", "passes 57", "passes 58", "passes 59"]
    # Nobody becomes a second pedestrian while it is carried on without a row.
    for frame in range(60, 90):
        here = ["stays"] if frame % 2 else []
        forecast = live.observe(frame, [*here, f"passes {frame}"], [[0.4 * frame, 0.0]] * len(here) + [[5.0, 5.0]])
        assert forecast.ids.tolist().count("stays") == 1 and all(isinstance(one, str) for one in forecast.ids)


def test_calls_of_several_threads_take_turns(forecaster, crossing, tmp_path):
    """Also with a close in between, and with as many threads as cores."""
    live = ddl.Live(forecaster, fps=2.5, memory=tmp_path / "turns.memory")
    turn = itertools.count()
    failed = []

    def watch():
        for _ in range(15):
            try:
                live.observe(next(turn), list(range(25)), crossing[:, 0] + 0.01)
            except ValueError as error:  # another thread has pushed a later frame
                if "after" not in str(error):
                    failed.append(error)
            assert live.remembered >= 0
            live.close()

    threads = [threading.Thread(target=watch) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not failed and not any(thread.is_alive() for thread in threads)


def test_an_empty_scene_has_all_fields(forecaster, crossing):
    absent = np.full((2, 8, 2), np.nan)
    some, empty = forecaster.forecast(crossing[:2], certificates=True), forecaster.forecast(absent, certificates=True)
    assert empty.paths.shape == (2, 20, 12, 2) and np.isnan(empty.regions(0.9)).all()
    for name in ("paths", "weights", "goals", "certified", "spread", "familiarity"):
        assert getattr(some, name).shape == getattr(empty, name).shape, name
    assert some.certificates.potentials.shape == empty.certificates.potentials.shape
    assert (
        baselines.angular_noise(absent).paths.shape == (2, 20, 12, 2)
        and baselines.constant_velocity(absent).goals is None
    )


def test_forecasts_are_written_for_the_program(forecaster, tracks, tmp_path):
    forecasts = forecaster.forecast_recording(ddl.read(tracks))
    ddl.write_forecasts(tmp_path / "made.jsonl", forecasts)
    lines = [json.loads(line) for line in (tmp_path / "made.jsonl").read_text().splitlines()]
    assert len(lines) == sum(len(forecast) for forecast in forecasts)
    assert lines[0]["hypotheses"][3]["positions"] == forecasts[0].paths[0, 3].tolist()
    with pytest.raises(ValueError, match="numbered"):
        ddl.write_forecasts(tmp_path / "made.jsonl", [forecaster.forecast(np.zeros((1, 8, 2)))])
    assert len((tmp_path / "made.jsonl").read_text().splitlines()) == len(lines)


def test_a_builtin_model_takes_precedence_over_a_folder(tmp_path, monkeypatch, crossing):
    (tmp_path / "world").mkdir()
    monkeypatch.chdir(tmp_path)
    assert pickle.loads(pickle.dumps(ddl.Forecaster())).forecast(crossing).valid.all()
    with pytest.raises(ValueError, match="world"):
        ddl.Forecaster("./world")


def test_goals_and_baselines(forecaster, crossing):
    goals, weights = forecaster.goals(crossing)
    forecast = forecaster.forecast(crossing)
    assert np.array_equal(goals, forecast.goals) and np.array_equal(weights, forecast.weights)
    last = crossing[:, -1] + 12 * (crossing[:, -1] - crossing[:, -2])
    assert np.allclose(baselines.constant_velocity(crossing).paths[:, 0, -1], last)
    lines = baselines.straight_line(crossing, goals)
    assert np.allclose(lines.paths[:, :, -1], goals) and lines.paths.shape == (25, 20, 12, 2)
    assert baselines.angular_noise(crossing, seed=3).paths.shape == (25, 20, 12, 2)
    for of in (baselines.mean_velocity, baselines.constant_acceleration, baselines.social_force):
        assert of(crossing).paths.shape == (25, 1, 12, 2)


def test_suspicious_input_gives_a_warning(forecaster, crossing, tracks, tmp_path):
    """Pixels, a wrong rate, and impossible motions each give a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        forecaster.forecast_recording(ddl.read(tracks), last=True)
    slow = ddl.Recording(
        np.arange(60), np.ones(60, int), np.arange(60) * 0.12, np.zeros(60)
    )  # 10 frames a second, taken as 2.5
    pixels = ddl.Recording(np.arange(20), np.ones(20, int), np.arange(20) * 40.0, np.zeros(20))
    for recording in (slow, pixels):
        with pytest.warns(ddl.DoubtWarning, match=r"recording: |unlike"):
            forecaster.forecast_recording(recording)
    with pytest.warns(ddl.DoubtWarning, match="recording: "):
        forecaster.show(slow, tmp_path / "slow.html")
    assert "Doubtful: nine in ten steps" in (tmp_path / "slow.html").read_text()
    with pytest.warns(ddl.DoubtWarning, match="recording: "), pytest.raises(ValueError, match="in metres"):
        forecaster.show(pixels)
    with pytest.warns(ddl.DoubtWarning, match="positions are in metres"):
        forecaster.forecast(crossing * 50)
    with pytest.warns(ddl.DoubtWarning, match="appears once") as told, ddl.Live(forecaster, fps=2.5) as live:
        for frame in range(12):
            live.observe(frame, [1], [[50.0 * frame, 0.0]])
    assert len(told) == 1


def test_wrong_kinds_of_arguments(forecaster, tracks, crossing):
    for call in (forecaster.forecast_recording, forecaster.show):
        with pytest.raises(TypeError, match="read"):
            call(str(tracks))
    with pytest.raises(TypeError, match="Forecaster"):
        ddl.Live("hotel", fps=10)
    with pytest.raises(ValueError, match=r"past\[None\]"):
        forecaster.forecast(crossing[0])
    assert repr(forecaster.forecast(crossing)) == "Forecast(25 pedestrians, 20 hypotheses)"


def test_joint_futures_and_their_answers(forecaster, crossing):
    scene = crossing[:6]
    forecast = forecaster.forecast(scene, joint=True)
    assert forecast.futures.shape == (20, 6, 12, 2) and forecast.certified.all()
    assert (forecast.weights == forecast.weights[0]).all() and np.isclose(forecast.weights[0].sum(), 1)
    plan = np.column_stack([0.4 * np.arange(1, 13), forecast.most_likely()[0]])
    far = plan + [0, 500, 0]
    risk = forecast.risk([plan, far])
    assert risk.total.shape == (2,) and risk.pedestrians.shape == (2, 6) and risk.until.shape == (2, 12)
    assert risk.total[0] > 0.1 and risk.total[1] < 1e-9
    assert forecast.risk([plan], seen=False).total[0] >= risk.total[0]
    assert forecast.risk([plan], ego=0).pedestrians[0, 0] == 0
    nearest, of_each = forecast.nearest([plan, far])
    assert nearest[0] < nearest[1] and of_each.shape == (2, 6)
    grid = forecast.occupancy(0.5, every=1.2)
    assert grid.probabilities.shape[0] == 5 and 0 <= grid.probabilities.min() <= grid.probabilities.max() <= 1
    assert len(grid.message(0)["data"]) == grid.probabilities[0].size
    given = forecaster.forecast(scene, joint=True, plan=plan, ego=5)
    assert np.allclose(given.futures[:, 5], plan[:, 1:])
    with pytest.raises(ValueError, match="already keep away"):
        given.risk([plan])
    assert given.risk([plan], seen=False).total.shape == (1,)
    scene = scene.copy()
    scene[1, :7] = np.nan
    seen_once = forecaster.forecast(scene, joint=True)
    assert seen_once.unseen[1] == 7 and not np.isnan(seen_once.risk([plan]).pedestrians).any()
    with pytest.warns(ddl.DoubtWarning, match="do not count: 1"):
        of_whole = forecaster.forecast(scene, joint=True, whole=True).risk([plan])
    assert np.isnan(of_whole.pedestrians[0]).tolist() == [False, True] + 4 * [False]
    with pytest.raises(ValueError, match="joint=True"):
        forecaster.forecast(scene).futures  # noqa: B018
    with pytest.raises(ValueError, match="sort the rows"):
        forecast.risk([plan[::-1]])
    with pytest.raises(ValueError, match="fewer times"):
        forecast.occupancy(0.05, every=0.01, area=(-20, -20, 20, 20))
    nobody = forecaster.forecast(np.full((2, 8, 2), np.nan), joint=True)
    assert nobody.risk([plan]).total == 0 and np.isinf(nobody.nearest([plan])[0]).all()
    assert not nobody.occupancy(0.5, area=(0, 0, 2, 1)).probabilities.any()
    for ask in (nobody.risk, nobody.nearest):
        with pytest.raises(ValueError, match="sort the rows"):
            ask([plan[::-1]])
    with pytest.raises(ValueError, match="give area="):
        nobody.occupancy()
    with pytest.raises(ValueError, match="is not among"):
        forecast.risk([plan], ego=77)
