# Writes transforms.json: transforms as they come, and where places of other frames are in the frame "map", by matrices.
# `python3 transforms.py` in this folder; it needs no package.
import json
import math


def matrix(axis, angle):
    """Rodrigues' formula."""
    length = math.hypot(*axis)
    x, y, z = (part / length for part in axis)
    c, s = math.cos(angle), math.sin(angle)
    return [
        [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
        [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
        [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
    ]


def out(pose, place):
    """A place of the frame, in its parent."""
    shift, axis, angle = pose
    return [shift[row] + sum(m * p for m, p in zip(matrix(axis, angle)[row], place)) for row in range(3)]


def into(pose, place):
    """A place of the parent, in the frame."""
    shift, axis, angle = pose
    moved = [p - s for p, s in zip(place, shift)]
    return [sum(matrix(axis, angle)[row][column] * moved[row] for row in range(3)) for column in range(3)]


def header(microseconds, frame):
    return {"stamp": {"sec": microseconds // 10**6, "nanosec": microseconds % 10**6 * 1000}, "frame_id": frame}


def point(x, y, z):
    return {"x": x, "y": y, "z": z}


def transform(time, parent, child, pose):
    shift, axis, angle = pose
    x, y, z = (math.sin(angle / 2) * part / math.hypot(*axis) for part in axis)
    rotation = {"x": x, "y": y, "z": z, "w": math.cos(angle / 2)}
    return {
        "header": header(time, parent),
        "child_frame_id": child,
        "transform": {"translation": point(*shift), "rotation": rotation},
    }


UP, TILTED = (0.0, 0.0, 1.0), (1.0, -2.0, 0.5)
# odom in map and lidar in base rest; base in odom turns and drives; the camera tilts.
MAP = ([2.0, -1.0, 0.0], UP, 0.7)
LIDAR = ([0.5, 0.25, 1.0], UP, -1.1)
CAMERA = ([0.25, -0.5, 1.5], TILTED, 0.9)
HALL = ([-3.0, 4.0, 0.0], UP, 2.0)
BASE = {1_000_000: ([1.0, 2.0, 0.0], UP, 0.2), 1_400_000: ([3.0, -1.0, 0.0], UP, 1.0)}
THEN = ([2.5, -0.25, 0.0], UP, 0.8)  # three quarters of the way
PLACE = (1.5, -0.75, 2.0)


def message(is_static, *transforms):
    return [is_static, {"transforms": transforms}]


def asked(time, frame, answer, is_held=False):
    answer = answer if isinstance(answer, str) else [answer[0], answer[1], is_held]
    return [header(time, frame), point(*PLACE), answer]


def odom(base, pose=([0.0, 0.0, 0.0], UP, 0.0), place=PLACE):
    return out(MAP, out(base, out(pose, place)))


RESTING = [
    message(True, transform(5, "/map", "odom", HALL)),
    # The newest one of a frame that rests counts, whatever its time.
    message(True, transform(0, "map", "odom", MAP), transform(9, "base", "/lidar", LIDAR)),
    message(True, transform(9, "base", "camera", CAMERA), transform(0, "hall", "map", HALL)),
]
MOVING = [message(False, transform(time, "odom", "base", BASE[time])) for time in (1_400_000, 1_000_000)]
LEVEL = (1.5, -0.75, 0.0)  # without a tilt, heights do not count
ASKED = [
    asked(5, "map", PLACE),
    asked(5, "odom", out(MAP, LEVEL)),
    asked(5, "hall", into(HALL, LEVEL)),
    asked(1_000_000, "base", odom(BASE[1_000_000])),
    asked(1_300_000, "base", odom(THEN)),
    asked(1_300_000, "/lidar", odom(THEN, LIDAR)),
    asked(1_300_000, "camera", odom(THEN, CAMERA)),
    asked(1_400_000, "lidar", odom(BASE[1_400_000], LIDAR)),
    asked(1_700_000, "lidar", odom(BASE[1_400_000], LIDAR), is_held=True),
    asked(1_700_001, "lidar", "the transform from base to odom is 0.300001 s old; --transform-age allows 0.3 s"),
    asked(999_999, "lidar", "the transform from base to odom begins after the tracks"),
    asked(5, "door", "no transform from door to map is known"),
    asked(5, "", "the tracks name no frame"),
]
# Time goes back by more than 2 s: what moved is forgotten. Less does not matter.
LATER = [message(False, transform(time, "odom", "base", BASE[1_400_000])) for time in (12_000_000, 10_000_000)]
CART = [message(False, transform(11_000_000, "odom", "cart", HALL))]
BACK = [message(False, transform(9_999_999, "odom", "base", BASE[1_000_000]))]
CASES = [
    (RESTING + MOVING, ASKED),
    # In another parent a frame begins anew.
    (
        RESTING + MOVING + [message(False, transform(1_500_000, "map", "base", HALL))],
        [asked(1_450_000, "base", "begins after the tracks"), asked(1_500_000, "base", out(HALL, LEVEL))],
    ),
    # After 10 s the first are forgotten.
    (RESTING + MOVING + LATER, [asked(1_700_000, "base", "begins after the tracks")]),
    (RESTING + MOVING + LATER[:1], [asked(1_999_999, "base", "begins after the tracks")]),
    (
        RESTING + LATER + CART,
        [
            asked(10_000_000, "base", odom(BASE[1_400_000])),
            asked(12_000_000, "base", odom(BASE[1_400_000])),
            asked(9_999_999, "base", "begins after the tracks"),
            asked(11_000_000, "cart", out(MAP, out(HALL, LEVEL))),
        ],
    ),
    (
        RESTING + LATER + CART + BACK,
        [
            asked(9_999_999, "base", odom(BASE[1_000_000])),
            asked(12_000_000, "base", "is 2.000001 s old"),
            asked(11_000_000, "cart", "no transform from cart to map"),
            asked(11_000_000, "odom", out(MAP, LEVEL)),
        ],
    ),
]

if __name__ == "__main__":
    with open("transforms.json", "w") as file:
        file.write("[\n" + ",\n".join(map(json.dumps, CASES)) + "\n]\n")
