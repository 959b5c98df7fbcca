"""Many recordings with Dask, many cameras with Zenoh and MQTT: runs the examples in separate processes."""

import json
import os
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import time
from pathlib import Path

import ddl_forecast as ddl
import numpy as np
import pytest

EXAMPLES = Path(__file__).parent.parent / "examples"


@pytest.fixture
def folder(tracks, tmp_path):
    """Six recordings of different lengths."""
    header, *rows = tracks.read_text().splitlines()
    made = tmp_path / "recordings"
    made.mkdir()
    for part in range(6):
        (made / f"part{part}.csv").write_text("\n".join([header, *rows[: 200 + 60 * part]]) + "\n")
    return made


def test_dask_gives_the_bits_of_one_process_though_a_worker_dies(folder, tmp_path, monkeypatch):
    distributed = pytest.importorskip("dask.distributed")
    monkeypatch.syspath_prepend(EXAMPLES)
    monkeypatch.setenv("PYTHONPATH", str(EXAMPLES))
    monkeypatch.setenv("RAYON_NUM_THREADS", "1")
    from forecast_file import forecast_file

    plain = tmp_path / "plain"
    plain.mkdir()
    forecaster = ddl.Forecaster()
    for path in sorted(folder.glob("*.csv")):
        forecast_file(str(path), str(plain), forecaster)
    out = tmp_path / "out"
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        victims = [worker["pid"] for worker in client.run(lambda: {"pid": os.getpid()}).values()]
        tasks = client.map(
            slow_forecast, sorted(map(str, folder.glob("*.csv"))), out=str(out), forecaster=forecaster, pure=False
        )
        while not any(out.glob("*.csv")):
            time.sleep(0.05)
        os.kill(victims[0], signal.SIGKILL)
        made = sorted(client.gather(tasks))
        assert victims[0] not in [worker["pid"] for worker in client.run(lambda: {"pid": os.getpid()}).values()]
    assert len(made) == 6
    for path in made:
        assert Path(path).read_bytes() == (plain / Path(path).name).read_bytes()
    assert {path.name for path in out.iterdir()} - {Path(path).name for path in made} <= {
        one.name for one in out.glob(".*")
    }


def slow_forecast(path, out, forecaster):
    """Takes long enough to be killed in the middle."""
    from forecast_file import forecast_file

    Path(out).mkdir(exist_ok=True)
    time.sleep(0.3)
    return forecast_file(path, out, forecaster)


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def frames_of(camera, count):
    """Two pedestrians who pass, another place for each camera."""
    for frame in range(count):
        yield {
            "frame": frame,
            "fps": 2.5,
            "ids": [1, 2],
            "xy": [[camera + 0.5 * frame, 0.0], [camera + 9 - 0.4 * frame, 1.0]],
        }


def test_twenty_cameras_over_zenoh_lose_nothing(tmp_path):
    zenoh = pytest.importorskip("zenoh")
    place = f"tcp/127.0.0.1:{free_port()}"
    program = subprocess.Popen(
        [sys.executable, EXAMPLES / "zenoh_cameras.py", "--listen", place, "--memory", tmp_path],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert program.stdout.readline().startswith("watching")
        config = zenoh.Config()
        config.insert_json5("connect/endpoints", json.dumps([place]))
        config.insert_json5("scouting/multicast/enabled", "false")
        answers, sent, times = {}, {}, []

        def heard(sample):
            answer = json.loads(sample.payload.to_bytes())
            key = (str(sample.key_expr).removeprefix("forecasts/"), answer["frame"])
            answers[key] = answer
            times.append(time.perf_counter() - sent[key])

        with zenoh.open(config) as session:
            subscriber = session.declare_subscriber("forecasts/**", heard)
            time.sleep(1)
            for frame in range(12):
                for camera in range(20):
                    name = f"camera{camera}"
                    sent[name, frame] = time.perf_counter()
                    session.put(f"tracks/{name}", json.dumps(list(frames_of(camera, 12))[frame]))
                time.sleep(0.1)
            session.put("tracks/camera0", b"no json")
            until = time.time() + 60
            while len(answers) < 240 and time.time() < until:
                time.sleep(0.05)
            subscriber.undeclare()
        assert len({key for key in answers if key[1] is not None}) == 240
        forecaster = ddl.Forecaster()
        live = ddl.Live(forecaster, fps=2.5, memory=tmp_path / "other.memory")
        for seen in frames_of(7, 12):
            expected = live.observe(seen["frame"], seen["ids"], seen["xy"])
        assert answers["camera7", 11]["paths"] == expected.paths.round(4).tolist()
        print(
            f"240 frames of 20 cameras: median {1e3 * statistics.median(times):.1f} ms, worst {1e3 * max(times):.1f} ms"
        )
    finally:
        program.send_signal(signal.SIGINT)
        program.wait(20)
        program.stdout.close()
    assert len(list(tmp_path.glob("camera*.memory"))) == 20


def test_the_program_as_a_filter_between_mqtt_topics(program):
    broker = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
    if broker is None or shutil.which("mosquitto_sub") is None:
        missing = "mosquitto and mosquitto_sub are not installed (apt install mosquitto mosquitto-clients)"
        pytest.fail(missing) if os.environ.get("CI") else pytest.skip(missing)
    port = str(free_port())
    started = [subprocess.Popen([broker, "-p", port], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)]
    try:
        wait_for(int(port))
        pipe = (
            f"mosquitto_sub -p {port} -t cam/7/tracks | {program} forecast - --frame-step 1 --one --format jsonl "
            f"| mosquitto_pub -p {port} -t cam/7/forecasts -l"
        )
        listener = subprocess.Popen(
            ["mosquitto_sub", "-p", port, "-t", "cam/7/forecasts", "-C", "4", "-W", "60"],
            stdout=subprocess.PIPE,
            text=True,
        )
        started += [subprocess.Popen(["sh", "-c", pipe], start_new_session=True), listener]
        time.sleep(2)
        lines = [
            f"{seen['frame']} {one} {x} {y}"
            for seen in frames_of(0, 10)
            for one, (x, y) in zip(seen["ids"], seen["xy"], strict=True)
        ]
        publisher = subprocess.Popen(
            ["mosquitto_pub", "-p", port, "-t", "cam/7/tracks", "-l"], stdin=subprocess.PIPE, text=True
        )
        for line in [*lines, ""]:
            publisher.stdin.write(line + "\n")
            publisher.stdin.flush()
        said = [json.loads(line) for line in listener.communicate(timeout=60)[0].splitlines()]
        publisher.stdin.close()
        publisher.wait(10)
        assert len(said) == 4 and {line["pedestrian"] for line in said} == {1, 2}
        assert all(np.isfinite(line["hypotheses"][0]["positions"]).all() for line in said)
    finally:
        if len(started) > 1:
            os.killpg(started[1].pid, signal.SIGTERM)
        for one in started:
            one.terminate()
            one.wait(10)
        if len(started) > 2:
            listener.stdout.close()


def wait_for(port):
    for _ in range(100):
        with socket.socket() as one:
            if one.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    pytest.fail("the broker did not start")
