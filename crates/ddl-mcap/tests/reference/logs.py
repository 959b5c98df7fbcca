# Writes logs.json: messages of logs, and the rows, notes and errors that are to come of them. `python3 logs.py` in this
# folder; it needs no package. A message: topic, type, encoding, nanoseconds of the log, data.
import json

PEOPLE, DETECTIONS = "people_msgs/msg/People", "vision_msgs/msg/Detection3DArray"
PERSONS = "spencer_tracking_msgs/TrackedPersons"
FAR = "x or y is not finite, or beyond 10,000 km"


def header(microseconds, names=("sec", "nanosec"), frame="odom"):
    # The 999 ns are cut off.
    parts = [microseconds // 10**6, microseconds % 10**6 * 1000 + (999 if microseconds else 0)]
    return {"stamp": dict(zip(names, parts)), "frame_id": frame}


def point(x, y):
    return {"x": x, "y": y, "z": 7.5}


def pose(x, y):
    return {"pose": {"pose": {"position": point(x, y)}}}


def box(x, y):
    return {"bbox": {"center": {"position": point(x, y)}, "size": point(9.0, 8.0)}}


def results(**classes):
    return {"results": [{"hypothesis": {"class_id": name, "score": score}} for name, score in classes.items()]}


def detections(time, x):
    likeliest = results(dog=0.2, person=0.7, car=0.1)
    return {
        "header": header(time, ("secs", "nsecs")),
        "detections": [
            {"id": "ann", "header": {"frame_id": "odom"}} | box(x, -2.0) | likeliest,
            {"id": 7} | box(-x, 3.0),
            {"id": "c"} | box(x, 1.0) | results(car=1.0),
            {"id": "d", "header": {"frame_id": "base"}} | box(x, 1.0) | likeliest,
        ],
    }


def persons(time, x):
    tracks = [{"track_id": "ann", "is_occluded": False} | pose(x, -2.0), {"track_id": 7} | pose(-x, 3.0)]
    occluded = [{"track_id": 8, "is_occluded": True}, {"track_id": 9, "is_occluded": True} | pose(1.0, 1.0)]
    return {"header": header(time, ("sec", "nsec")), "tracks": tracks + occluded}


def people(time, x):
    velocity = {"velocity": point(9.0, 8.0), "reliability": 1.0, "tagnames": [], "tags": []}
    rows = [("ann", x, -2.0), ("7", -x, 3.0), ("far", 0.0, 2e7)]
    rows = [{"name": name, "position": point(x, y)} | velocity for name, x, y in rows]
    return {"header": header(time), "people": rows}


def case(messages, rows=(), notes=(), asked=None, restarts=0, frame="odom", error=None, file=None):
    # Times are microseconds, of which 400,000 are a step.
    found = {"rows": rows, "notes": notes, "restarts": restarts, "frame": frame, "step": 400_000}
    return {"messages": messages, "file": file, "asked": asked, "found": found, "error": error}


KINDS = [
    (
        DETECTIONS,
        "json",
        detections,
        ", classes read person; 2 rows left out: class car; 2 rows left out: in another frame",
    ),
    (PERSONS, "json", persons, "; 4 rows left out: occluded"),
    (PEOPLE, "json", people, "; 2 rows left out: " + FAR),
    (PEOPLE, "cdr", people, "; 2 rows left out: " + FAR),
]


def kinds():
    """Times of messages, or of the log where those are 0; in microseconds, the rest of nanoseconds is cut off."""
    for kind, encoding, make, told in KINDS:
        for of, stamps in [("messages", [100_050_000, 103_137_000]), ("log", [0, 0])]:
            logged = [200_000_001_999, 200_400_002_000]
            times = stamps if of == "messages" else [200_000_001, 200_400_002]
            messages = [["/seen", kind, encoding, at, make(t, x)] for at, t, x in zip(logged, stamps, [1.5, 2.25])]
            rows = [row for t, x in zip(times, [1.5, 2.25]) for row in ([t, "7", -x, 3.0], [t, "ann", x, -2.0])]
            name = kind.replace("msgs/T", "msgs/msg/T")
            note = f"topic /seen ({name} as {encoding}, 2 messages): times of the {of}, positions in the frame"
            yield case(messages, rows, [f'{note} "odom"{told}'])


TEXT = ["/chatter", "std_msgs/String", "json", 1, {"data": "hi"}]


def on(topic, x):
    return [
        topic,
        PEOPLE,
        "json",
        2,
        {"header": header(1_000_000), "people": [{"name": "7", "position": point(x, 3.0)}]},
    ]


def topics():
    one, two = [TEXT, on("/b", 1.5)], [on("/a", 0.5), TEXT, on("/b", 1.5)]
    kind = "(people_msgs/msg/People as json, 1 messages)"
    note = ': times of the messages, positions in the frame "odom"'
    for messages, asked, topic, x in [(one, None, "/b", 1.5), (two, "/b", "/b", 1.5), (two, "/a", "/a", 0.5)]:
        yield case(messages, [[1_000_000, "7", x, 3.0]], [f"topic {topic} {kind}{note}"], asked)
    for messages, asked, error in [
        (two, None, f"several topics hold tracks, choose one (topic): /a {kind}, /b {kind}"),
        (one, "/chatter", "topic /chatter holds no tracks but std_msgs/msg/String as json; read is"),
        (one, "/c", f"no message of topic /c; there are /b {kind}, /chatter (std_msgs/msg/String as json, 1 mess"),
        ([TEXT], None, "no tracks in /chatter (std_msgs/msg/String as json, 1 messages); read is"),
        ([], None, "there is no message; is the file empty"),
        ([*one, on("/b", 2.5)], None, "pedestrian 7 is there twice at 1.000000 s"),
    ]:
        yield case(messages, asked=asked, error=error)


def line(fields):
    return ["/line", "", "json", 2_000_001_000, {"track": {"p": 1, "x": 0.5, "y": -2.0} | fields}]


def lines():
    # Only more than 2 s back from the row before: once, to 2.4.
    times = [1.0, 4.5, 2.5, 5.0, 2.4, 2.0]
    rows = [[round(1e6 * t), "1", 0.5, -2.0] for t in sorted(times)]
    note = 'topic /line ( as json, {} messages): times of the {}, positions in the frame ""'
    yield case([line({"t": t}) for t in times], rows, [note.format(6, "messages")], restarts=1, frame=None)
    yield case([line({"f": 5})], [[2_000_001, "1", 0.5, -2.0]], [note.format(1, "log")], frame=None)
    for error, data in [
        ("names the scene hall", line({"t": 1, "scene": "hall"})[4]),
        ("holds the tracks of one moment", "\n".join(json.dumps(line({"t": t})[4]) for t in (1, 2))),
    ]:
        yield case([["/line", "", "json", 1, data]], error=error)


def wrong():
    at = {"sec": 2.0, "nanosec": "2500"}

    def one(stamp=at, frame="odom", place=None, name="a"):
        row = {"name": name, "position": place or {"x": 1.0, "y": 2.0}}
        return {"header": {"stamp": stamp, "frame_id": frame}, "people": [row]}

    for second, error in [
        (one({}), "header.stamp is 0 in some messages and a time in others"),
        (one({"sec": 2.5}), "header.stamp.sec is 2.5; it must be a whole number"),
        (one(frame="map"), 'positions in the frame "map", but before in "odom"; record them in one'),
        (one(place={"x": 1.0}), "each of `people` needs /name, and x and y of /position (m)"),
        (one(name=""), "each of `people` needs /name, and x and y of /position (m)"),
        (one(name=257 * "a"), "pedestrian aaa"),
        ({"detections": []}, "there is no list `people`"),
    ]:
        messages = [["/p", PEOPLE, "json", 1_250_000_000, data] for data in (one(), second)]
        yield case(messages, error=f"topic /p, message 1 at 1.250000 s: {error}")
    note = "topic /p (people_msgs/msg/People as json, 2 messages): times of the messages, positions in the frame"
    early = one({"sec": 0, "nanosec": 250_000_000})
    messages = [["/p", PEOPLE, "json", 1, data] for data in (early, one(place={"x": 1.0, "y": None}))]
    yield case(messages, [[250_000, "a", 1.0, 2.0]], [f'{note} "odom"; 1 rows left out: {FAR}'])
    messages = [["/p", PEOPLE, "json", 1, one(name=name)] for name in ("a", "b")]
    yield case(messages, [[2_000_002, name, 1.0, 2.0] for name in ("a", "b")], [f'{note} "odom"'])


def corpus():
    """Files of `tests/fuzz/corpus/mcap`, which other programs wrote: three straight walks."""
    classes, occluded = ", classes read person; 10 rows left out: class car", "; 10 rows left out: occluded"
    for file, kind, told in [
        ("people_zstd", f"/people ({PEOPLE} as cdr, 10 messages)", ""),
        ("detections_lz4", f"/detections ({DETECTIONS} as cdr, 10 messages)", classes),
        ("persons_json", "/persons (spencer_tracking_msgs/msg/TrackedPersons as json, 10 messages)", occluded),
        ("lines_json", "/tracks ( as json, 10 messages)", ""),
    ]:
        frame = None if file == "lines_json" else "map"
        note = f'topic {kind}: times of the messages, positions in the frame "{frame or ""}"{told}'
        rows = []
        for k in range(10):
            t = 100 + 0.4 * k
            s = t - 100
            walks = [(1.2 * s, 0.0), (9 - 1.1 * s, 0.8), (3.0, 0.9 * s - 2)]
            rows += [[round(1e6 * t), str(i + 1), x, y] for i, (x, y) in enumerate(walks)]
        yield case([], rows, [note], frame=frame, file=file)


if __name__ == "__main__":
    cases = [*kinds(), *topics(), *lines(), *wrong(), *corpus()]
    with open("logs.json", "w") as file:
        file.write("[\n" + ",\n".join(map(json.dumps, cases)) + "\n]\n")
