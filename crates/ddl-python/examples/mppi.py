"""A sampling planner (MPPI): a robot plays one pedestrian of a recording and walks to where that one goes.

At every frame: the joint futures of everybody else, the risk of 2,000 plans around the last one,
and the mean of the plans by what they cost.

    python mppi.py TRACKS FPS PEDESTRIAN
"""

import sys
import time

import ddl_forecast as ddl
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEP, STEPS, ROLLOUTS, FASTEST = 0.4, 12, 2000, 1.6
RADIUS, WITHIN = 0.3, 0.2  # of the robot, and how close to its edge nobody should come, metres


def sample(nominal: Floats, random: np.random.Generator) -> Floats:
    """Velocities (ROLLOUTS, STEPS, 2) around the nominal ones, which are the first; the noise lasts."""
    noise = random.normal(0.0, 0.25, (ROLLOUTS, STEPS, 2))
    for step in range(1, STEPS):
        noise[:, step] += 0.8 * noise[:, step - 1]
    noise[0] = 0.0
    velocities = nominal + noise
    speeds = np.linalg.norm(velocities, axis=2, keepdims=True)
    return np.asarray(velocities * np.minimum(1.0, FASTEST / np.maximum(speeds, 1e-9)))


def plans_of(at: Floats, velocities: Floats) -> Floats:
    """Rows (t, x, y, radius) of the plans that start at `at`: (ROLLOUTS, STEPS + 1, 4)."""
    plans = np.empty((len(velocities), STEPS + 1, 4))
    plans[:, :, 0] = STEP * np.arange(STEPS + 1)
    plans[:, 0, 1:3] = at
    plans[:, 1:, 1:3] = at + STEP * velocities.cumsum(axis=1)
    plans[:, :, 3] = RADIUS
    return plans


def costs_of(plans: Floats, velocities: Floats, risks: Floats, goal: Floats) -> Floats:
    """A collision costs most, then every second away from the goal; changes of velocity cost a little."""
    changes = np.linalg.norm(np.diff(velocities, axis=1), axis=2).sum(axis=1)
    away = np.linalg.norm(plans[:, :, 1:3] - goal, axis=2).sum(axis=1)
    return np.asarray(20.0 * risks + 0.1 * (away + changes))


def main(tracks: str, fps: float, pedestrian: str) -> None:
    recording, forecaster, random = ddl.read(tracks, fps=fps), ddl.Forecaster(), np.random.default_rng(0)
    mine = recording.id.astype(str) == pedestrian
    if not mine.any():
        sys.exit(f"{tracks} has no pedestrian {pedestrian}")
    goal = np.array([recording.x[mine][-1], recording.y[mine][-1]])
    begin = recording.frame[mine][0]
    robot = np.array([recording.x[mine][0], recording.y[mine][0]])
    nominal = np.zeros((STEPS, 2))
    closest, spent = np.inf, []
    with ddl.Live(forecaster, fps=fps, joint=True) as live:
        before = begin
        for frame in np.unique(recording.frame):
            here = (recording.frame == frame) & ~mine
            people = np.column_stack([recording.x[here], recording.y[here]])
            now = live.observe(int(frame), recording.id[here], people)
            if frame < begin or np.linalg.norm(goal - robot) < 0.5:
                continue
            passed = (frame - before) / fps
            robot = robot + passed * nominal[0]
            nominal[:-1] += min(passed / STEP, 1.0) * np.diff(nominal, axis=0)
            before = frame
            if len(people) > 0:
                closest = min(closest, float(np.linalg.norm(people - robot, axis=1).min()))
            started = time.process_time()
            velocities = sample(nominal, random)
            plans = plans_of(robot, velocities)
            risks = np.zeros(ROLLOUTS) if now is None else now.risk(plans, within=WITHIN).total
            spent.append(time.process_time() - started)
            costs = costs_of(plans, velocities, risks, goal)
            weights = np.exp((costs.min() - costs) / 0.2)
            nominal = np.asarray(np.tensordot(weights / weights.sum(), velocities, 1))
            print(f"frame {frame}  robot ({robot[0]:.1f}, {robot[1]:.1f})  risk of the last plan {risks[0]:.2f}")
    print(f"{np.linalg.norm(goal - robot):.1f} m from the goal, {closest:.2f} m from somebody at the closest; ", end="")
    print(f"sampling and risks of {ROLLOUTS} plans: {1e3 * float(np.median(spent)):.0f} ms")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(sys.argv[1], float(sys.argv[2]), sys.argv[3])
