# Writes messages.json: a forecast without symmetry with the messages that it is, and messages of trackers with the
# pedestrians in them. `python3 messages.py` in this folder; it needs no package.
import json
import re
import struct

WEIGHTS = [[0.125, 0.5, 0.375], [0.625, 0.125, 0.25]]
CERTIFIED = [[True, False, False], [False, True, True]]
NAMES, AGES, FAMILIARITIES = ["ann", "7"], [0.3, 0.1], [0.75, 0.25]
MOMENT = -1_399_995  # microseconds, before 0


def single(number):
    return struct.unpack("f", struct.pack("f", number))[0]


def stamp(microseconds):
    return {"sec": microseconds // 10**6, "nanosec": microseconds % 10**6 * 1000}


def header(microseconds=MOMENT, frame="odom"):
    return {"stamp": stamp(microseconds), "frame_id": frame}


def point(x=0.0, y=0.0, z=0.0):
    return {"x": x, "y": y, "z": z}


def pose(*position):
    return {"position": point(*position), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}


def color(a):
    return {"r": single(0.11), "g": single(0.37), "b": single(0.76), "a": single(a)}


def place(i, k, t):
    """Where pedestrian i is t steps after the moment; for t = 0 the same in all hypotheses."""
    return [1.0 + 10 * i + (0.5 + k) * t, -2.0 - 7 * i + (0.25 - k) * t * t]


def goal(i, k):
    return place(i, k, 13)


def scales(i):
    return [0.5 + i + 0.25 * t for t in range(12)]


def forecasts(full):
    def hypothesis(i, k):
        path = [place(i, k, t) for t in range(1, 13)]
        return {
            "weight": WEIGHTS[i][k],
            "certified": full and CERTIFIED[i][k],
            "goal": point(*goal(i, k)) if full else point(None, None),
            "x": [x for x, _ in path],
            "y": [y for _, y in path],
        }

    def pedestrian(i):
        return {
            "id": NAMES[i],
            "position": point(*place(i, 0, 0)),
            "age": AGES[i],
            "familiarity": FAMILIARITIES[i] if full else None,
            "scales": scales(i) if full else [],
            "hypotheses": [hypothesis(i, k) for k in range(3)],
        }

    return {"header": header(), "time_step": 0.4, "joint": full, "pedestrians": [pedestrian(0), pedestrian(1)]}


def likeliest(i):
    k = [1, 0][i]
    return [place(i, k, t) for t in range(13)]


def path(i):
    poses = [{"header": header(MOMENT + 400_000 * t), "pose": pose(*p)} for t, p in enumerate(likeliest(i))]
    return {"header": header(), "poses": poses}


def marker(name, kind, size, points, colors):
    return {
        "header": header(),
        "ns": name,
        "id": 0,
        "type": kind,
        "action": 0,
        "pose": pose(),
        "scale": point(size, size),
        "color": color(1),
        "lifetime": {"sec": 1, "nanosec": 0},
        "frame_locked": False,
        "points": [point(*p) for p in points],
        "colors": colors,
        "texture_resource": "",
        "texture": {"header": {"stamp": stamp(0), "frame_id": ""}, "format": "", "data": []},
        "uv_coordinates": [],
        "text": "",
        "mesh_resource": "",
        "mesh_file": {"filename": "", "data": []},
        "mesh_use_embedded_materials": False,
    }


LINES = [point for i in range(2) for pair in zip(likeliest(i), likeliest(i)[1:]) for point in pair]
ENDS = [place(i, k, 12) for i in range(2) for k in range(3)]
SHARES = [0.25, 1, 0.75, 1, 0.2, 0.4]  # of the largest weight of the pedestrian

FORECAST = {
    "past": [[[1.0 + 10 * i - 0.5 * (7 - t), -2.0 - 7 * i] for t in range(8)] for i in range(2)],
    "ages": AGES,
    "positions": [place(i, k, t) for i in range(2) for k in range(3) for t in range(1, 13)],
    "weights": WEIGHTS[0] + WEIGHTS[1],
    "goals": [goal(i, k) for i in range(2) for k in range(3)],
    "certified": CERTIFIED[0] + CERTIFIED[1],
    "scales": scales(0) + scales(1),
    "familiarities": FAMILIARITIES,
}
GRID = {
    "header": header(MOMENT + 800_000),
    "info": {
        "map_load_time": stamp(MOMENT),
        "resolution": 0.5,
        "width": 3,
        "height": 2,
        "origin": pose(-1.5, 2.0),
    },
    "data": [0, 0, 1, 13, 99, 100],
}

# Messages of trackers. Fields that are not to be read have numbers, too.
NOT_HERE = point(9.0, 8.0, 7.0)
NOT_HERE_EITHER = {"pose": pose(6.0, 5.0), "covariance": [[1.0] * 6] * 6}
TWIST = {"twist": {"linear": NOT_HERE, "angular": NOT_HERE}, "covariance": [[2.0] * 6] * 6}
FAR = "x or y is not finite, or beyond 10,000 km"


def detection(name, frame, position, **classes):
    results = [{"hypothesis": {"class_id": c, "score": score}, "pose": NOT_HERE_EITHER} for c, score in classes.items()]
    box = {"center": pose(*position), "size": NOT_HERE}
    return {"header": header(7, frame), "results": results, "bbox": box, "id": name}


def person(name, *position):
    fields = {"name": name, "position": point(*position), "velocity": NOT_HERE, "reliability": 1.0}
    return fields | {"tagnames": ["class"], "tags": ["car"]}


def track(number, is_occluded, *position):
    where = {"pose": pose(*position), "covariance": [[1.0] * 6] * 6}
    state = {"track_id": number, "is_occluded": is_occluded, "is_matched": True, "detection_id": 34}
    return state | {"age": {"sec": 3, "nanosec": 0}, "pose": where, "twist": TWIST}


def case(kind, seen, rows=(), left_out=None, moment=MOMENT, error=None):
    field = {"Detection3DArray": "detections", "People": "people", "TrackedPersons": "tracks"}[kind]
    # Names that are no numbers as these are printed, below 2^53, have numbers from there on.
    numbers = [
        [min(int(n), 2**53) if re.fullmatch("0|-?[1-9][0-9]*", n) else 2**53, n, [p["x"], p["y"]]] for n, _, p in rows
    ]
    expected = [header(moment), rows, left_out or {}, numbers]
    return {"kind": kind, "message": {"header": header(moment), field: seen}, "expected": expected, "error": error}


NUMBERED = ["ann", "7", "07", "-3", str(2**53), str(2**53 - 1)]
CASES = [
    case(
        "Detection3DArray",
        [
            detection("ann", "odom", (0.5, -1.25, 3.0), dog=0.25, person=0.625, car=0.125),
            detection("base", "base", (1.0, 2.0)),
            detection("far", "", (-1e7, 1e7)),
            *[detection("x", "", position) for position in [(1.1e7, 0.0), (0.0, 1.1e7), (0.0, -1.1e7)]],
        ],
        rows=[["ann", "person", point(0.5, -1.25, 3.0)], ["far", "", point(-1e7, 1e7)]],
        left_out={"in another frame": 1, FAR: 3},
    ),
    case(
        "People",
        [person(name, 0.5 + i, -1.25 * i, 3.0) for i, name in enumerate(NUMBERED)],
        moment=400_000,
        rows=[[name, "", point(0.5 + i, -1.25 * i, 3.0)] for i, name in enumerate(NUMBERED)],
    ),
    case(
        "TrackedPersons",
        [track(11, True, 0.0, 0.0), track(12, False, 0.5, -1.25, 3.0), track(13, True, 0.0, 0.0)],
        rows=[["12", "", point(0.5, -1.25, 3.0)]],
        left_out={"occluded": 2},
    ),
    case("People", [person("a", 1.0, 2.0), person("", 1.0, 2.0)], error="people[1] has no name"),
    case("Detection3DArray", [detection("", "", (1.0, 2.0))], error="detections[0] has no id"),
    case("TrackedPersons", [track(1, False, 1.0, 2.0)], moment=0, error="must set header.stamp"),
]

if __name__ == "__main__":
    messages = {
        "forecast": FORECAST,
        "full": forecasts(True),
        "bare": forecasts(False),
        "paths": [path(0), path(1)],
        "markers": {
            "markers": [
                marker("likeliest", 5, 0.05, LINES, []),
                marker("ends", 8, 0.12, ENDS, [color(share) for share in SHARES]),
            ]
        },
        "grid": GRID,
        "cases": CASES,
    }
    with open("messages.json", "w") as file:
        file.write("{\n" + ",\n".join(f"{json.dumps(key)}: {json.dumps(messages[key])}" for key in messages) + "\n}\n")
