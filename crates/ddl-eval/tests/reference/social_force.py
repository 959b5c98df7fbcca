# Prints the positions of the tests in src/baseline/social_force.rs at the first, sixth and last step: the social force
# model with a gradient of differences. numpy 2.
import numpy as np

TAU, V0, SIGMA, FORESIGHT, DT, SUBSTEPS = 0.5, 2.1, 0.3, 2.0, 0.05, 8


def potential(r, stride, direction):
    around = np.hypot(*r) + np.hypot(*(r - stride * direction))
    return V0 * np.exp(-0.5 * np.sqrt(around**2 - stride**2) / SIGMA)


def push(r, stride, direction, h=3e-5):
    steps = np.eye(2) * h
    at = lambda d: potential(r + d, stride, direction)
    return -np.array([(8 * (at(d) - at(-d)) - at(2 * d) + at(-2 * d)) / (12 * h) for d in steps])


def forecast(motions):
    starts, steps = np.array(motions, float).transpose(1, 0, 2)
    here, wanted = starts + 7 * steps, steps / 0.4
    speed = np.hypot(*wanted.T)
    direction = wanted / np.maximum(speed, 1e-300)[:, None]
    velocity, path, capped = wanted.copy(), [], False
    for t in range(12 * SUBSTEPS):
        strides = FORESIGHT * np.hypot(*velocity.T)
        force = (wanted - velocity) / TAU
        for i in range(len(here)):
            for j in range(len(here)):
                if i != j and speed[i] > 0:
                    p = push(here[i] - here[j], strides[j], direction[j])
                    ahead = -(p @ direction[i]) > np.cos(np.radians(100)) * np.hypot(*p)
                    force[i] += p * (1 if ahead else 0.5)
        velocity = velocity + DT * force
        now = np.hypot(*velocity.T)
        capped |= bool((now > 1.3 * speed + 1e-12)[speed > 0].any())
        velocity *= np.minimum(1, 1.3 * speed / np.maximum(now, 1e-300))[:, None]
        here = here + DT * velocity
        if t % SUBSTEPS == SUBSTEPS - 1:
            path.append(here)
    return np.array(path)[[0, 5, 11]].transpose(1, 0, 2).round(6), capped


for motions in (
    [([-3.5, 0], [0.5, 0]), ([6.8, 0.3], [-0.4, 0]), ([-4.55, 0.35], [0.56, 0]), ([2.2, -0.9], [0, 0])],
    [([1, -2], [0.03, 0.06]), ([0.6, -4.75], [0.06, 0.4]), ([4, 1.2], [-0.3, -0.1])],
):
    print(*forecast(motions), sep="\n")
