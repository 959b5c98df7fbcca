"""Forecasts on every clock: any frame rate, time stamps, and pedestrians with clocks of their own."""

import pickle
import warnings

import ddl_forecast as ddl
import numpy as np
import pytest

PEDESTRIANS = 4
SECONDS = 8.0


def place(one, time):
    """Positions on a slightly bent path, walked at 1 to 1.3 m/s."""
    along, aside = (1.0 + 0.1 * one) * time, 0.1 * np.sin(0.7 * time)
    return np.column_stack([3 * one + aside, along])


def rows_at(times_of):
    """Columns time, id, x and y of each pedestrian at its times, in order of time."""
    parts = [(time, np.full(len(time), one), *place(one, time).T) for one, time in enumerate(times_of)]
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    order = np.lexsort((columns[1], columns[0]))
    return [column[order] for column in columns]


def film(fps):
    """Frame numbers instead of times."""
    frame = np.arange(int(SECONDS * fps))
    _, one, x, y = rows_at([frame / fps] * PEDESTRIANS)
    return np.repeat(frame, PEDESTRIANS), one, x, y


def own_clocks():
    """Rows 0.1 s apart on average, at times of their own, in whole milliseconds."""
    rng = np.random.default_rng(5)
    times = [np.arange(0.03 * one, SECONDS, 0.1) for one in range(PEDESTRIANS)]
    return rows_at([np.round(time + rng.uniform(-0.02, 0.02, len(time)) + 1, 3) for time in times])


def assert_same_bits(ours, theirs):
    assert len(ours) == len(theirs)
    for one, other in zip(ours, theirs, strict=True):
        assert one.frame == other.frame and np.array_equal(one.ids, other.ids)
        for name in ("paths", "goals", "past", "unseen", "age", "deviation", "uncertainty"):
            assert np.array_equal(getattr(one, name), getattr(other, name)), name
        # Weights adapt when forecasts have ended; the likeliest stays the likeliest.
        assert np.allclose(one.weights, other.weights, atol=0.05), "weights"
        assert np.array_equal(one.weights.argmax(axis=1), other.weights.argmax(axis=1))


@pytest.mark.parametrize("fps", [2.5, 7, 9, 23.976, 25, 30])
def test_every_rate_is_forecast(forecaster, fps):
    recording = ddl.Recording(*film(fps), fps=fps)
    assert np.array_equal(np.unique(recording.frame), np.arange(int(SECONDS * fps)))
    assert recording.frame_step == pytest.approx(0.4 * fps, rel=0.005)
    made = forecaster.forecast_recording(recording)
    assert [forecast.frame for forecast in made] == list(range(int(SECONDS * fps)))
    last = made[-1]
    assert len(last) == PEDESTRIANS and (last.unseen == 0).all() and (last.age == 0).all()
    assert np.allclose(last.frames, last.frame + 0.4 * fps * np.arange(1, 13), rtol=0.005)
    for one in range(PEDESTRIANS):
        now = last.frame / fps
        assert np.allclose(last.past[one], place(one, now - 0.4 * np.arange(8)[::-1]), atol=0.05)
        ends = np.linalg.norm(last.paths[one, :, -1] - place(one, np.array([now + 4.8])), axis=1)
        assert ends.min() < 1, ends


@pytest.mark.parametrize("fps", [7, 23.976, None])
def test_later_rows_change_no_forecast(forecaster, fps):
    """Rows after a moment are moved and lost; forecasts until then keep their bits."""
    when, one, x, y = own_clocks() if fps is None else film(fps)
    until = when[len(when) // 2]
    moved = np.where(when > until, x + 3.0, x)
    kept = (when <= until) | (np.arange(len(when)) % 3 != 0)
    every = 0.4 if fps is None else None

    def forecasts(x, kept):
        kind = {"time": when[kept]} if fps is None else {"frame": when[kept], "fps": fps}
        recording = ddl.Recording(id=one[kept], x=x[kept], y=y[kept], **kind)
        return forecaster.forecast_recording(recording, every=every)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ddl.DoubtWarning)
        true, other = forecasts(x, np.full(len(x), True)), forecasts(moved, kept)
    early = [[forecast for forecast in made if forecast.frame <= until] for made in (true, other)]
    assert len(early[0]) > 5
    assert_same_bits(*early)
    assert not np.array_equal(true[-1].past, other[-1].past)


@pytest.mark.parametrize("fps", [7, 23.976, None])
def test_live_has_the_bits_of_the_recording(forecaster, fps):
    when, one, x, y = own_clocks() if fps is None else film(fps)
    kind = {"time": when} if fps is None else {"frame": when, "fps": fps}
    every = 0.4 if fps is None else 0.0
    recording = ddl.Recording(id=one, x=x, y=y, **kind)
    made = []
    with ddl.Live(forecaster, fps=fps, every=every) as live:
        for at in np.unique(when):
            now = when == at
            moment = {"time": at} if fps is None else {"frame": at}
            made.append(live.observe(ids=one[now], xy=np.column_stack([x[now], y[now]]), **moment))
    made = [forecast for forecast in made if forecast is not None]
    assert len(made) > 10
    assert_same_bits(made, forecaster.forecast_recording(recording))


def test_joint_futures_do_not_depend_on_who_came_first(forecaster, tmp_path):
    frame, one, x, y = film(2.5)
    name = np.array(["zoe", "bob", "anna", "carl"])[one]
    recording = ddl.Recording(frame, name, x, y, fps=2.5)
    recording.write(tmp_path / "by_frame.csv")
    head, *rows = (tmp_path / "by_frame.csv").read_text().splitlines()
    rows.sort(key=lambda row: (row.split(",")[1], int(row.split(",")[0])))
    (tmp_path / "by_name.csv").write_text("\n".join([head, *rows]))
    files = [ddl.read(tmp_path / f"{order}.csv", fps=2.5) for order in ("by_frame", "by_name")]
    with ddl.Live(forecaster, fps=2.5, joint=True) as live:
        for at in np.unique(frame):
            now = frame == at
            last = live.observe(at, name[now], np.column_stack([x[now], y[now]]))
        with pytest.raises(ValueError, match="pedestrian bob is in frame 99 twice"):
            live.observe(99, ["bob", "bob"], [[0, 0], [1, 1]])
    for rows in (recording, pickle.loads(pickle.dumps(recording)), *files):
        (made,) = forecaster.forecast_recording(rows, last=True, joint=True)
        order = [made.ids.tolist().index(one) for one in last.ids]
        # The order of the pedestrians changes the rounding.
        assert np.allclose(made.paths[order], last.paths, atol=1e-5) and np.allclose(made.weights[order], last.weights)


def test_pedestrians_with_clocks_of_their_own(forecaster):
    time, one, x, y = own_clocks()
    made = forecaster.forecast_recording(ddl.Recording(time=time, id=one, x=x, y=y))
    moments = np.array([forecast.frame for forecast in made])
    # On time, or at the first row after it.
    assert (np.abs(np.diff(moments) - 0.4) < 0.06).all() and len(moments) > 15
    assert all(len(forecast) == PEDESTRIANS for forecast in made[1:])
    with pytest.raises(ValueError, match="between two frames"):
        ddl.write_forecasts("unused.jsonl", forecaster.forecast_recording(ddl.Recording(*film(7), fps=7)))
    rows = ddl.Recording(time=time, id=one, x=x, y=y)
    assert forecaster.forecast_recording(rows, last=True)[0].frame == time.max()
    last = made[-1]
    assert (last.age < 0.15).all() and (last.age > 0).any() and last.frames[0] == pytest.approx(last.frame + 0.4)
    for i, one in enumerate(last.ids):
        assert np.allclose(last.past[i], place(one, last.frame - 0.4 * np.arange(8)[::-1]), atol=0.05)


def test_times_in_all_kinds(forecaster, tmp_path):
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    time, one, x, y = own_clocks()
    seconds = ddl.Recording(time=time, id=one, x=x, y=y)
    assert np.array_equal(seconds.frame, time) and seconds.frame_step == 0.4
    expected = forecaster.forecast_recording(seconds)
    start = np.datetime64("2026-03-01T12:00:00", "us")
    dates = start + np.round(time * 1e6).astype("timedelta64[us]")
    naive = pandas.Series(dates)
    for kind in (
        dates,
        dates.astype("datetime64[ns]"),
        dates.tolist(),
        naive,
        naive.dt.tz_localize("UTC").dt.tz_convert("Asia/Tokyo"),
        polars.Series(dates),
    ):
        recording = ddl.Recording(time=kind, id=one, x=x, y=y)
        assert np.array_equal(recording.frame, dates) and recording.frame_step == 0.4
        made = forecaster.forecast_recording(recording)
        assert [forecast.frame - start for forecast in made] == [
            np.timedelta64(round(forecast.frame * 1e6), "us") for forecast in expected
        ]
        assert all(np.array_equal(a.paths, b.paths) for a, b in zip(made, expected, strict=True))
        assert made[0].frames.dtype == dates.dtype
    columns = forecaster.forecast_table(time=dates, id=one, x=x, y=y, last=True)
    assert columns["frame"].dtype == dates.dtype and columns["observed_until"][0] == dates.max()
    for recording in (seconds, ddl.Recording(time=dates, id=one, x=x, y=y)):
        for path in (tmp_path / "times.csv", tmp_path / "times.ndjson"):
            recording.write(path, format="table" if path.suffix == ".csv" else "trajnet")
            for back in (ddl.read(path), pickle.loads(pickle.dumps(recording))):
                for column in ("frame", "id", "x", "y"):
                    assert np.array_equal(getattr(back, column), getattr(recording, column)), column
                assert_same_bits(forecaster.forecast_recording(back), forecaster.forecast_recording(recording))
        with pytest.raises(ValueError, match="times"):
            recording.write(tmp_path / "times.txt", format="obsmat")


@pytest.mark.parametrize(("unit", "count"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_files_keep_the_unit_of_their_times(tmp_path, unit, count):
    time, one, x, y = own_clocks()
    path = tmp_path / "times.csv"
    rows = zip(time, one, x.tolist(), y.tolist(), strict=True)
    lines = [f"{round(t * count)},{i},{a!r},{b!r}" for t, i, a, b in rows]
    path.write_text(f"time_{unit},pedestrian,x,y\n" + "\n".join(lines))
    recording = ddl.read(path)
    assert recording.frame.tolist() == [round(t * count) for t in time] and recording.frame_step == 0.4 * count
    recording.write(tmp_path / "again.csv")
    again = ddl.read(tmp_path / "again.csv")
    assert np.array_equal(again.frame, recording.frame) and again.frame_step == recording.frame_step


def test_wrong_times_are_named():
    good = {"id": [1, 1], "x": [0.0, 0.5], "y": [0.0, 0.0]}
    for change, words in [
        ({}, "frame or time, one of the two"),
        ({"frame": [0, 1], "time": [0.0, 0.4]}, "frame or time, one of the two"),
        ({"time": [0.0, np.nan]}, "row 1, column time"),
        ({"time": [0.0, 1e12]}, "row 1, column time"),
        ({"time": np.array(["2026-01-01", "NaT"], "datetime64[s]")}, "row 1, column time"),
        ({"time": ["12:00", "12:01"]}, "column time must hold seconds or datetimes"),
        ({"time": [0.4, 0.4]}, "pedestrian 1 is in time 0.4 twice"),
        ({"time": [0.0, 0.4], "fps": 25}, "times"),
        ({"time": [0.0, 0.4], "frame_step": 1}, "times"),
        ({"time": [0.4]}, "time, id, x and y must have one length"),
        ({"time": [0.0, 2.0]}, "2.00 s apart"),
    ]:
        with pytest.raises(ValueError, match=r".") as error:
            ddl.Recording(**good, **change)
        assert words in str(error.value)


def test_a_live_clock_counts_frames_or_times(forecaster):
    counted, timed = ddl.Live(forecaster, fps=7), ddl.Live(forecaster)
    with pytest.raises(ValueError, match="frame instead of time"):
        counted.observe(time=0.4, ids=[1], xy=[[0, 0]])
    with pytest.raises(ValueError, match="needs Live"):
        timed.observe(0, [1], [[0, 0]])
    with pytest.raises(ValueError, match="one of the two"):
        timed.observe(ids=[1], xy=[[0, 0]])
    counted.observe(5, [1], [[0, 0]])
    timed.observe(time=0.5, ids=[1], xy=[[0, 0]])
    with pytest.raises(ValueError, match="frame 3 comes after frame 5"):
        counted.observe(3, [1], [[0, 0]])
    with pytest.raises(ValueError, match=r"time 0\.3 comes after time 0\.5"):
        timed.observe(time=0.3, ids=[1], xy=[[0, 0]])
    with pytest.raises(ValueError, match="pedestrian 1 is in frame 6 twice"):
        counted.observe(6, [1, 1], [[0, 0], [1, 1]])
    for fps in (0, -7, np.nan, np.inf):
        with pytest.raises(ValueError, match="fps"):
            ddl.Live(forecaster, fps=fps)
    for option in ("max_age", "every"):
        for value in (-0.1, 2.1, np.nan):
            with pytest.raises(ValueError, match=option):
                ddl.Live(forecaster, fps=7, **{option: value})


def test_age_and_interval(forecaster):
    """A pedestrian is carried on until its last row is too old; moments are as far apart as asked for."""
    frame, one, x, y = film(10)
    kept = (one != 2) | (frame <= frame[-1] - 3)
    recording = ddl.Recording(frame[kept], one[kept], x[kept], y[kept], fps=10)
    (last,) = forecaster.forecast_recording(recording, last=True)
    assert last.ids.tolist() == [0, 1, 2, 3] and last.age.tolist() == pytest.approx([0, 0, 0.3, 0])
    assert np.allclose(last.past[2, -1], place(2, last.frame / 10), atol=0.1)
    for age, count in ((0, 3), (0.2, 3), (0.35, 4)):
        (forecast,) = forecaster.forecast_recording(recording, last=True, max_age=age)
        assert len(forecast) == count, age
    assert [forecast.frame for forecast in forecaster.forecast_recording(recording, every=1.0)][:3] == [0, 10, 20]
    late = (one != 3) | (frame > frame[-1] - 2)
    recording = ddl.Recording(frame[late], one[late], x[late], y[late], fps=10)
    (last,) = forecaster.forecast_recording(recording, last=True)
    assert last.unseen.tolist() == [0, 0, 0, 7] and (last.uncertainty > 0).tolist() == [False, False, False, True]
    (whole,) = forecaster.forecast_recording(recording, last=True, whole=True)
    assert whole.ids.tolist() == [0, 1, 2]


def test_doubtful_rows_give_one_warning(forecaster):
    frame, one, x, y = film(7)
    wrong = x.copy()
    wrong[(frame == 20) & (one == 1)] += 30
    recording = ddl.Recording(frame, one, wrong, y, fps=7, name="hall")
    with pytest.warns(ddl.DoubtWarning) as told:
        made = forecaster.forecast_recording(recording)
    said = [str(warning.message) for warning in told if "left out" in str(warning.message)]
    assert len(said) == 1 and "hall: 1 position is left out" in said[0] and "pedestrian 1 at frame 20" in said[0]
    true = forecaster.forecast_recording(ddl.Recording(frame, one, x, y, fps=7))
    assert np.allclose(made[-1].past, true[-1].past, atol=0.05)
    with pytest.warns(ddl.DoubtWarning, match="left out"):
        forecaster.show(recording)
    # Rows of pedestrian 3 that lie too far apart to belong together: each is a first one.
    rare = (one != 3) | (frame % 28 == 0)
    made = forecaster.forecast_recording(ddl.Recording(frame[rare], one[rare], x[rare], y[rare], fps=7))
    assert {unseen for forecast in made for unseen in forecast.unseen[forecast.ids == 3]} == {7}
    past = np.stack([place(0, 0.4 * np.arange(8)), place(1, 0.4 * np.arange(8))])
    past[1, 5] += 20
    with pytest.warns(ddl.DoubtWarning, match=r"past\[1, 5\]"):
        forecast = forecaster.forecast(past)
    assert forecast.valid.all() and np.allclose(forecast.past[1, 5], place(1, np.array([2.0])), atol=0.1)
