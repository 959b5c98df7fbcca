"""MCAP files and rosbag2 recordings by the programs of others: read, and written for them."""

import csv
import io
import json
import math
import shutil
from pathlib import Path

import pytest
from conftest import run
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

PEOPLE = "people_msgs/msg/People"
PERSON_DEFINITION = """string name
geometry_msgs/Point position
geometry_msgs/Point velocity
float64 reliability
string[] tagnames
string[] tags
"""
PEOPLE_DEFINITION = "std_msgs/Header header\npeople_msgs/Person[] people\n"
LATE = 5_000_000  # nanoseconds from a message to its entry in the log


@pytest.fixture(scope="module")
def store():
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(PERSON_DEFINITION, "people_msgs/msg/Person"))
    store.register(get_types_from_msg(PEOPLE_DEFINITION, PEOPLE))
    return store


def rows():
    """Three pedestrians at 10 Hz for 6 s: time, name, x, y."""
    for k in range(60):
        t = 1_700_000_000 + 0.1 * k
        yield t, [("p1", 0.12 * k, 0.0), ("p2", 9 - 0.11 * k, 0.8), ("p3", 3.0, 0.09 * k - 2)]


def messages(store):
    """The same, and a row without a place, as messages: nanoseconds and CDR."""
    kinds = store.types
    for t, people in rows():
        nanoseconds = round(t * 10) * 100_000_000
        stamp = kinds["builtin_interfaces/msg/Time"](nanoseconds // 10**9, nanoseconds % 10**9)
        point = kinds["geometry_msgs/msg/Point"]
        persons = [
            kinds["people_msgs/msg/Person"](
                name=name,
                position=point(x, y, math.nan),
                velocity=point(0.0, 0.0, 0.0),
                reliability=1.0,
                tagnames=[],
                tags=[],
            )
            for name, x, y in [*people, ("lost", math.nan, 0.0)]
        ]
        message = kinds[PEOPLE](kinds["std_msgs/msg/Header"](stamp, "odom"), persons)
        yield nanoseconds, bytes(store.serialize_cdr(message, PEOPLE))


@pytest.fixture(scope="module")
def folder(store, tmp_path_factory):
    """The tracks as csv, as bags of both kinds and as bare MCAP files, and what the program says of the csv."""
    folder = tmp_path_factory.mktemp("logs")
    lines = ["time,pedestrian,x,y"]
    lines += [f"{t:.1f},{name},{x!r},{y!r}" for t, people in rows() for name, x, y in people]
    (folder / "tracks.csv").write_text("\n".join(lines) + "\n")
    for name, storage in [("bag", StoragePlugin.MCAP), ("sqlite", StoragePlugin.SQLITE3)]:
        with BagWriter(folder / name, version=9, storage_plugin=storage) as bag:
            topic = bag.add_connection("/people", PEOPLE, typestore=store)
            other = bag.add_connection("/chatter", "std_msgs/msg/String", typestore=store)
            for nanoseconds, cdr in messages(store):
                bag.write(topic, nanoseconds + LATE, cdr)
                bag.write(other, nanoseconds, b"\0\1\0\0\3\0\0\0hi\0")
    for compression in [CompressionType.ZSTD, CompressionType.LZ4, CompressionType.NONE]:
        with (folder / f"{compression.name}.mcap").open("wb") as file:
            writer = Writer(file, compression=compression, chunk_size=4000)
            writer.start()
            topic = writer.register_channel("/people", "cdr", writer.register_schema(PEOPLE, "ros2msg", b""))
            for nanoseconds, cdr in messages(store):
                writer.add_message(topic, nanoseconds + LATE, cdr, nanoseconds)
            writer.finish()
    return folder


def table(text):
    return list(csv.DictReader(io.StringIO(text)))


@pytest.fixture(scope="module")
def expected(program, folder):
    return table(run(program, "forecast", folder / "tracks.csv", check=True).stdout)


@pytest.mark.parametrize("log", ["bag", "bag/bag.mcap", "ZSTD.mcap", "LZ4.mcap", "NONE.mcap"])
def test_logs_give_the_forecasts_of_the_same_csv(program, folder, expected, log):
    done = run(program, "forecast", folder / log, check=True)
    assert table(done.stdout) == expected
    told = "topic /people (people_msgs/msg/People as cdr, 60 messages): times of the messages, positions in the frame"
    assert told + ' "odom"; 60 rows left out: x or y is not finite' in done.stderr


def test_every_message_of_a_written_file_is_decoded(program, folder, expected, store):
    out = folder / "out.mcap"
    done = run(program, "forecast", folder / "bag", "-o", out, check=True)
    counts, found = {}, {}
    with out.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            counts[schema.name] = counts.get(schema.name, 0) + 1
            if channel.topic == "/people":
                stamp = decoded.header.stamp
                assert message.log_time == stamp.sec * 10**9 + stamp.nanosec
            if channel.topic == "/ddl/forecasts":
                assert decoded.header.frame_id == "odom" and decoded.time_step == 0.4
                for one in decoded.pedestrians:
                    for k, hypothesis in enumerate(one.hypotheses):
                        place = list(zip(hypothesis.x, hypothesis.y, strict=True))
                        found[message.log_time, one.id, k] = (hypothesis.weight, place)
    moments = len({row["observed_until"] for row in expected})
    assert summary.statistics.message_count == sum(counts.values())
    assert counts == {
        PEOPLE: 60,
        "ddl_msgs/msg/Forecasts": moments,
        "visualization_msgs/msg/MarkerArray": moments,
        "nav_msgs/msg/Path": 3 * moments,
    }
    assert 12 * len(found) == len(expected)
    for index, row in enumerate(expected):
        moment = round(float(row["observed_until"]) * 10) * 100_000_000
        weight, place = found[moment, row["pedestrian"], int(row["hypothesis"])]
        x, y = place[index % 12]
        assert weight == float(row["weight"])
        assert max(abs(x - float(row["x"])), abs(y - float(row["y"]))) < 5.1e-5  # the table is rounded

    without = run(program, "forecast", folder / "tracks.csv", "-o", folder / "csv.mcap", check=True)
    assert "coordinate frame assumed: map" in without.stderr and "frame assumed" not in done.stderr
    again = run(program, "forecast", out, "--topic", "/people", check=True)
    assert table(again.stdout) == expected
    with AnyReader([out]) as bag:
        assert {connection.topic for connection in bag.connections} >= {"/people", "/ddl/markers"}
        for connection, _, raw in bag.messages():
            bag.deserialize(raw, connection.msgtype)


def test_what_cannot_be_read_is_named(program, folder, tmp_path):
    def error(*arguments):
        done = run(program, *arguments)
        assert done.returncode == 1 and not done.stdout
        return done.stderr

    assert "rosbags-convert --src BAG --dst NEW --dst-storage mcap" in error("forecast", folder / "sqlite")
    assert "no message of topic /tracks; there are" in error("forecast", folder / "bag", "--topic", "/tracks")
    with (tmp_path / "two.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        kind = writer.register_schema("", "", b"")
        topics = [writer.register_channel(topic, "json", kind) for topic in ["/a", "/b"]]
        for k in range(8):
            for topic in topics:
                writer.add_message(topic, k * 400_000_000, b'{"track": {"f": 1, "p": 1, "x": 0.5, "y": 2}}', 0, k)
        writer.add_message(topics[1], 4_000_000_000, b'{"track": {"f": 1, "p": 1, "x": "left", "y": 2}}', 0, 8)
        writer.finish()
    wrong = error("data", tmp_path)
    assert "topic /b, message 8 at 4.000000 s: the message, line 1: track.x must be" in wrong
    assert "--topic reads another topic" in wrong
    assert "times of the log" in run(program, "data", tmp_path, "--topic", "/a", check=True).stderr
    whole = (folder / "ZSTD.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    assert "cut.mcap is cut off" in run(program, "data", tmp_path / "cut.mcap", check=True).stderr
    shutil.copytree(folder / "bag", tmp_path / "bag")
    (tmp_path / "bag/bag.mcap").rename(tmp_path / "bag/other.mcap")
    assert "metadata.yaml lists bag.mcap, which is missing" in error("forecast", tmp_path / "bag")
    (tmp_path / "bag/bag.mcap").write_bytes(whole)
    unlisted = run(program, "data", tmp_path / "bag", check=True).stderr
    assert "MCAP files that metadata.yaml does not list are not read: 1, first" in unlisted and "other.mcap" in unlisted
    words = "MCAP has no place for --certificate and --region"
    for option in [["--certificate"], ["--region", "0.9"]]:
        assert words in error("forecast", folder / "ZSTD.mcap", *option, "-o", tmp_path / "x.mcap")
    shutil.rmtree(tmp_path)


def json_log(file, kind, message):
    with file.open("wb") as to:
        writer = Writer(to)
        writer.start()
        topic = writer.register_channel("/seen", "json", writer.register_schema(kind, "jsonschema", b"{}"))
        for k in range(24):
            second, nanosecond = divmod(100_050_000_000 + 137_000_000 * k, 10**9)
            writer.add_message(topic, 1, json.dumps(message(k, second, nanosecond)).encode(), 1)
        writer.finish()


def test_whole_numbers_of_json_have_any_type(program, tmp_path):
    def people(of):
        def message(k, second, nanosecond):
            header = {"frame_id": "map", "stamp": {"sec": of(second), "nanosec": of(nanosecond)}}
            return {"header": header, "people": [{"name": "1", "position": {"x": 0.16 * k, "y": 0}}]}

        return message

    for of in (int, float, str):
        json_log(tmp_path / "log.mcap", PEOPLE, people(of))
        told = run(program, "data", tmp_path / "log.mcap", check=True).stdout
        assert "100.05 s to 103.201 s" in told, told
    json_log(tmp_path / "log.mcap", PEOPLE, people(lambda number: number + 0.5))
    assert "header.stamp.sec is 100.5; it must be" in run(program, "data", tmp_path / "log.mcap").stderr

    def detections(k, second, nanosecond):
        result = {"hypothesis": {"class_id": 7, "score": 0.9}}
        place = {"center": {"position": {"x": 0.16 * k, "y": 0}}}
        header = {"frame_id": "map", "stamp": {"sec": second, "nanosec": nanosecond}}
        return {"header": header, "detections": [{"id": "1", "bbox": place, "results": [result]}]}

    json_log(tmp_path / "log.mcap", "vision_msgs/msg/Detection3DArray", detections)
    assert "classes read 7" in run(program, "data", tmp_path / "log.mcap", "--keep", "class=7", check=True).stderr
    none = run(program, "data", tmp_path / "log.mcap", "--keep", "class=person").stderr
    assert "24 rows left out: class 7; no row is left" in none


def test_two_recordings_in_one_log_are_told(program, tmp_path):
    def line(scene):
        return lambda k, *_: {"track": {"t": 0.4 * (k % 12), "p": k // 12, "x": 0.5 * (k % 12), "y": 2} | scene}

    json_log(tmp_path / "log.mcap", "", line({}))
    done = run(program, "forecast", tmp_path / "log.mcap", "--last", check=True)
    assert "begin again in the file (1 x)" in done.stderr
    json_log(tmp_path / "log.mcap", "", line({"scene": "hall"}))
    refused = run(program, "forecast", tmp_path / "log.mcap")
    assert refused.returncode == 1 and "names the scene hall; record each scene on a topic of its own" in refused.stderr


def test_grids_have_the_frame_of_the_log(program, folder):
    done = run(program, "occupancy", folder / "NONE.mcap", "--last", "--cell", "0.5", check=True)
    assert {json.loads(line)["header"]["frame_id"] for line in done.stdout.splitlines()} == {"odom"}


def test_a_csv_is_written_as_mcap_too(program, folder):
    out = folder / "of_csv.mcap"
    run(program, "forecast", folder / "tracks.csv", "--last", "--joint", "-o", out, check=True)
    with Path(out).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        [forecast] = [it.decoded_message for it in reader.iter_decoded_messages(topics=["/ddl/forecasts"])]
    assert forecast.joint and forecast.header.frame_id == "map"
    assert [one.id for one in forecast.pedestrians] == ["p1", "p2", "p3"]
    assert (
        "only forecasts are written as MCAP"
        in run(program, "occupancy", folder / "tracks.csv", "--last", "-o", folder / "grid.mcap").stderr
    )
