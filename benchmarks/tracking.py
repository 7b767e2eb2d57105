"""Measures how well the simulated hand follows a moving pose, and what impulse it needs for that.

The hand is in free air and is commanded 12 s of random minimum-jerk movements from legal pose to
legal pose, one command a control period, held in between. Errors are against the command that is
in force, so that they hold the servos' lag; the lag is the shift in time that explains most.

    python -m benchmarks.tracking
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import mujoco
import numpy as np

from benchmarks.machine import describe_machine
from models.arithmetic.arrays import Array
from models.hand import IMPULSE_PERIOD, SERVOS, Hand
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION
from models.rotations import geodesic_angle, quaternion_log
from models.scene import CONTROL_PERIOD, Scene, SceneSpec
from models.skeleton import ADULT
from tasks.simulated_user.fingers import minimum_jerk

DURATION = 12.0
"""s."""
SEED = 20
MOVEMENT = (0.5, 1.0)
"""s, range of a movement's duration; people's single movements of hand and fingers take so long."""
REACH, TURN = 0.06, 0.5
"""m and rad per axis, within which the root's places and turns are drawn."""
LEGAL_SHARE = 0.9
"""Share of every joint's range in which poses are drawn."""
LONGEST_LAG = 0.4
"""s that is looked for."""

IMPULSES = (100.0, 0.5, 0.1, 0.03, 0.01)
TIMESTEPS = (0.001, 0.002, 0.004)


@dataclass(frozen=True)
class Use:
    """The largest share of its limit that any of some servos used.

    Attributes:
        impulse: N s or N m s, most that it gave in 1/60 s, as Bullet counts a motor's impulse.
        peak: The same had it given its largest force all the time: below this, a limit binds.
    """

    impulse: float
    peak: float

    def __str__(self) -> str:
        return f"{self.impulse:.2g}, {self.peak:.2g}"


@dataclass(frozen=True)
class Tracking:
    """Result of one hand that followed a motion.

    Attributes:
        joint_rms, joint_max: degrees, of the ball joints.
        root_rms, root_turn_rms: mm and degrees, of the root.
        joint_lag, root_lag: ms; infinite where the hand is lost altogether.
        root, turn, joint: What the slides of the root (N s), its turn and the finger joints
            (N m s) used of their limits.
    """

    joint_rms: float
    joint_max: float
    root_rms: float
    root_turn_rms: float
    joint_lag: float
    root_lag: float
    root: Use
    turn: Use
    joint: Use


def trajectory(seed: int = SEED, period: float = CONTROL_PERIOD) -> Array:
    """(T, 48) commands, one every `period` seconds."""
    rng = np.random.default_rng(seed)
    middle = np.concatenate([[0, 0, 0.3], np.zeros(3), (ADULT.lower + ADULT.upper) / 2])
    half = LEGAL_SHARE * (ADULT.upper - ADULT.lower) / 2
    half = np.concatenate([np.full(3, REACH), np.full(3, TURN), half])
    commands: list[Array] = []
    start = np.concatenate([middle[:6], np.zeros(42)])
    while len(commands) * period < DURATION:
        end = middle + half * rng.uniform(-1.0, 1.0, 48)
        steps = round(rng.uniform(*MOVEMENT) / period)
        shares = [minimum_jerk(i / steps) for i in range(1, steps + 1)]
        commands += [start + share * (end - start) for share in shares]
        start = end
    return np.array(commands[: round(DURATION / period)])


def measure(commands: Array, servo: str, impulse: float, timestep: float) -> Tracking:
    """Plays commands (T, 48) to a hand, and compares at every physics step."""
    scene = Scene(SceneSpec((Hand(servo=servo, impulse=impulse),), timestep=timestep))
    model, data = scene.model, mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, commands[0])
    held = np.repeat(commands, scene.substeps, axis=0)
    qpos, force = np.empty((len(held), model.nq)), np.empty((len(held), model.nu))
    for i, command in enumerate(held):
        data.ctrl[:] = command
        mujoco.mj_step(model, data)
        qpos[i], force[i] = data.qpos, data.actuator_force
    poses = np.concatenate(
        [qpos[:, :3], quaternion_log(qpos[:, 3:].reshape(-1, 15, 4)).reshape(-1, 45)], axis=1
    )
    joint = np.rad2deg(
        geodesic_angle(poses[:, JOINTS].reshape(-1, 14, 3), held[:, JOINTS].reshape(-1, 14, 3))
    )
    turn = np.rad2deg(geodesic_angle(poses[:, ROOT_ROTATION], held[:, ROOT_ROTATION]))
    place = 1000.0 * np.linalg.norm(poses[:, ROOT_POSITION] - held[:, ROOT_POSITION], axis=1)
    slides, turns = force[:, :3, None], force[:, 3:].reshape(len(held), 15, 3)
    return Tracking(
        _rms(joint),
        float(joint.max()),
        _rms(place),
        _rms(turn),
        1000.0 * lag(poses[:, JOINTS], held[:, JOINTS], timestep),
        1000.0 * lag(poses[:, ROOT_POSITION], held[:, ROOT_POSITION], timestep),
        use(slides, timestep),
        use(turns[:, :1], timestep),
        use(turns[:, 1:], timestep),
    )


def lag(followed: Array, held: Array, timestep: float) -> float:
    """s by which values (n, k) come late, to part of a step; infinite beyond `LONGEST_LAG`."""
    most = round(LONGEST_LAG / timestep)
    late = followed[most:]
    costs = np.array(
        [np.mean((late - held[most - s : len(held) - s]) ** 2) for s in range(most + 1)]
    )
    best = int(np.argmin(costs))
    if not 0 < best < most:
        return 0.0 if best == 0 else np.inf
    # The lowest point of a parabola through the best shift and its neighbours.
    left, middle, right = costs[best - 1 : best + 2]
    return (best + 0.5 * (left - right) / (left - 2 * middle + right)) * timestep


def use(force: Array, timestep: float) -> Use:
    """Use of servos with forces (T, n, 1) in N or torques (T, n, 3) in N m."""
    given = np.cumsum(np.concatenate([np.zeros_like(force[:1]), force]), axis=0) * timestep
    # A period is not a whole number of steps: its beginning lies between two of them.
    whole, part = divmod(IMPULSE_PERIOD / timestep, 1.0)
    ends = np.arange(int(whole) + 1, len(given))
    first = ends - int(whole)
    begin = (1.0 - part) * given[first] + part * given[first - 1]
    return Use(
        float(np.linalg.norm(given[ends] - begin, axis=2).max()),
        float(np.linalg.norm(force, axis=2).max() * IMPULSE_PERIOD),
    )


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=SEED, help="of the movements")
    args = parser.parse_args()
    commands = trajectory(args.seed)
    speed = np.linalg.norm(np.diff(commands[:, :3], axis=0), axis=1).max() / CONTROL_PERIOD
    print(describe_machine())
    print(
        f"{len(commands)} commands in {DURATION:g} s, seed {args.seed}; "
        f"the root's fastest commanded speed is {speed:.2f} m/s"
    )
    print(
        "| servo | limit, N s | step, ms | joints rms (max), deg | root rms, mm | root rms, deg "
        "| lag of fingers, root, ms | root used, peak, N s | its turn, N m s | a joint, N m s |"
    )
    print("|" + " --- |" * 10)
    for servo in SERVOS:
        for impulse in IMPULSES:
            for timestep in TIMESTEPS:
                t = measure(commands, servo, impulse, timestep)
                print(
                    f"| {servo} | {impulse:g} | {1000 * timestep:g} "
                    f"| {t.joint_rms:.2f} ({t.joint_max:.1f}) | {t.root_rms:.1f} "
                    f"| {t.root_turn_rms:.2f} | {t.joint_lag:.1f}, {t.root_lag:.1f} "
                    f"| {t.root} | {t.turn} | {t.joint} |"
                )


if __name__ == "__main__":
    main()
