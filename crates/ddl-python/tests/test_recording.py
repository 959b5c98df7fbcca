"""Files and columns of tracks."""

import pickle

import ddl_forecast as ddl
import numpy as np
import pytest
from ddl_forecast._recording import FORMATS, WRITTEN


@pytest.mark.parametrize("format", WRITTEN)
def test_a_written_recording_is_read_back(format, tmp_path, tracks):
    recording = ddl.read(tracks)
    path = tmp_path / (
        "tracks.txt" if format in ("social-gan", "obsmat") else "tracks.ndjson" if format == "trajnet" else "tracks.csv"
    )
    recording.write(path, format=format)
    for back in (ddl.read(path), ddl.read(path, format=format)):
        for column in ("frame", "id", "x", "y"):
            assert np.array_equal(getattr(back, column), getattr(recording, column)), column
    again = pickle.loads(pickle.dumps(recording))
    assert np.array_equal(again.x, recording.x) and again.frame_step == recording.frame_step


def test_every_format_is_named(tmp_path):
    (tmp_path / "x.csv").write_text("frame,id,x,y\n")
    with pytest.raises(ValueError, match="not a known") as error:
        ddl.read(tmp_path / "x.csv", format="none")
    names = str(error.value).split("choose one of ")[1]
    assert set(names.split(", ")) == set(FORMATS)


def test_words_and_rates(tmp_path):
    frame = np.repeat(np.arange(0, 40), 2)
    recording = ddl.Recording(frame, ["ann", "bob"] * 40, np.arange(80) * 0.01, np.zeros(80), fps=24, name="lobby")
    assert recording.frame_step == pytest.approx(9.6) and set(recording.id.tolist()) == {"ann", "bob"}
    assert np.array_equal(recording.frame, frame)
    recording.write(tmp_path / "x.csv")
    back = ddl.read(tmp_path / "x.csv", fps=24)
    again = pickle.loads(pickle.dumps(recording))
    for one in (back, again):
        assert np.array_equal(one.frame, frame) and np.array_equal(one.x, recording.x)
        assert one.frame_step == recording.frame_step
    whole = ddl.Recording(frame, ["ann, a", "bob"] * 40, np.arange(80) * 0.01, np.zeros(80))
    whole.write(tmp_path / "words.csv")
    assert set(ddl.read(tmp_path / "words.csv").id.tolist()) == {"ann, a", "bob"}
    with pytest.raises(ValueError, match="word"):
        whole.write(tmp_path / "words.txt", format="obsmat")
    file = tmp_path / "x.ndjson"
    ddl.Recording(10 * frame, [1, 2] * 40, np.arange(80) * 0.01, np.zeros(80)).write(file, format="trajnet")
    file.write_text('{"scene": {"id": 0, "p": 1, "s": 0, "e": 390, "fps": 2}}\n' + file.read_text())
    with pytest.warns(ddl.DoubtWarning, match="read as fps=20"):
        assert ddl.read(file).frame_step == 8
    with pytest.warns(ddl.DoubtWarning, match="read as fps=25, although the file gives 2 frames per second"):
        assert ddl.read(file, fps=25).frame_step == 10


def test_misaligned_and_strided_arrays_are_copied(tmp_path):
    packet = b"....." + np.arange(4.0).tobytes()
    x = np.frombuffer(packet, "<f8", offset=5)
    recording = ddl.Recording([0, 1, 2, 3], [1, 1, 1, 1], x, np.arange(8.0)[::2])
    assert recording.x.tolist() == [0, 1, 2, 3] and recording.y.tolist() == [0, 2, 4, 6]


def test_windows_have_the_frames_of_the_recording():
    frame = np.arange(0, 24 * 12)
    recording = ddl.Recording(frame, np.ones(len(frame), int), frame / 24, np.zeros(len(frame)), fps=24)
    window = ddl.windows(recording)[0]
    assert window.frame_step == pytest.approx(9.6) and window.frame in recording.frame
    assert np.allclose(window.past[0, -1, 0], window.frame / 24)


def test_an_error_names_the_fault(tmp_path):
    good = {"frame": [0, 1], "id": [1, 1], "x": [0.0, 0.5], "y": [0.0, 0.0]}
    for change, words in [
        ({"x": [0.0, np.nan]}, "row 1, column x"),
        ({"frame": [0, 0.5]}, "row 1, column frame"),
        ({"x": ["a", "b"]}, "column x"),
        ({"frame": [0, 0]}, "twice"),
        ({"y": [0.0]}, "one length"),
        ({"id": ["a", None]}, "row 1, column id"),
        ({"id": ["a", "a"], "frame": [0, 0]}, "in frame 0 twice"),
        ({"id": [1.0, np.inf]}, "row 1, column id"),
        ({"id": [True, False]}, "column id"),
        ({"frame": [0, 2**60]}, "row 1, column frame"),
        ({"x": np.ma.masked_equal([0.0, 1.0], 1.0)}, "masked"),
        ({"x": [[0.0, 1.0]]}, "one dimension"),
        ({"fps": -1}, "fps"),
        ({"fps": 5, "frame_step": 2}, "not both"),
    ]:
        with pytest.raises(ValueError, match=r".") as error:
            ddl.Recording(**{**good, **change})
        assert words in str(error.value)
    with pytest.raises(FileNotFoundError, match="nowhere"):
        ddl.read(tmp_path / "nowhere.csv")
    bad = tmp_path / "bad.csv"
    bad.write_text("frame,pedestrian,x,y\n0,1,2.0,3.0\n10,1,2.5,oops\n")
    with pytest.raises(ValueError, match="line 3, field 4"):
        ddl.read(bad)
    with pytest.raises(ValueError, match='"excel" is not a known format'):
        ddl.read(bad, format="excel")
    numbers = ddl.Recording(**{**good, "id": np.array([3, np.int64(3)], dtype=object)})
    assert numbers.id.tolist() == [3, 3]
    fast = ddl.Recording(np.arange(20), np.ones(20, int), np.arange(20) * 40.0, np.zeros(20))
    assert fast.doubt()


def test_columns_rows_and_units_can_be_chosen(tmp_path):
    path = tmp_path / "camera.csv"
    path.write_text("frame,who,east,north,class\n0,1,150,250,ped\n10,1,160,250,ped\n0,2,0,0,cyclist\n")
    columns = {"pedestrian": "who", "x": "east", "y": "north"}
    with pytest.warns(ddl.DoubtWarning, match="1 of class cyclist"):
        recording = ddl.read(path, columns=columns, unit="cm")
    assert (recording.x[0], recording.y[0]) == (1.5, 2.5) and len(recording) == 2
    with pytest.warns(ddl.DoubtWarning, match="2 with class ped"):
        other = ddl.read(path, columns=columns, keep={"class": "cyclist"})
    assert len(other) == 1
    with pytest.raises(ValueError, match="still missing: pedestrian, x, y"):
        ddl.read(path)
    with pytest.raises(ValueError, match="unit must be m, cm, mm or px"):
        ddl.read(path, unit="km")
