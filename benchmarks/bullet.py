"""Compares a hand in Bullet with ours: same skeleton, masses, movement, limit and measures.

Both hands are in free air and follow 12 s of random movements, one commanded pose every 1/60 s,
which is constant in between. Bullet's hand has ball joints with Bullet's own motors. Its rate and
gains are searched. Every hand is compared with the current command at the end of each 1/60 s,
before the next command.

    pip install "hand-sandbox[bullet]"
    python -m benchmarks.bullet
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.bullet_hand import BulletHand
from benchmarks.machine import describe_machine
from models.arithmetic import Array
from models.hand import IMPULSE_PERIOD, SERVOS, Hand
from models.kinematics import Kinematics
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION
from models.rotations import geodesic_angle, quaternion_log
from models.scene import CONTROL_PERIOD, Scene, SceneSpec
from models.skeleton import ADULT
from tasks.simulated_user.user_hand import minimum_jerk

DURATION = 12.0
"""Duration (s) of the movements."""
SEED = 20
MOVEMENT = (0.5, 1.0)
"""Range (s) of a movement's duration, as of people's single movements of hand and fingers."""
REACH, TURN = 0.06, 0.5
"""Largest position (m) and rotation (rad) of the root, per axis, that are drawn."""
LEGAL_SHARE = 0.9
"""Share of every joint's range from which poses are drawn."""
TIMESTEPS = (0.001, 0.002, 0.004)
RATE = 60
"""Number of commands a second."""
RATES = (60, 120, 240)
"""Numbers of steps a second of Bullet that are tried."""
GAINS = (0.1, 0.2, 0.3, 0.5, 0.7, 0.85, 1.0)
DEFAULT_ERP = 0.2
"""Default ERP of pybullet. Its ball joint motors multiply their gain by the ERP. All other rows use
an ERP of 1."""
LIMITS = (100.0, 10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
"""Limits that are tried: N s of the slides, N m s of the rotations, per 1/60 s."""
COSTS, LEAST_COST = 1.1, 0.05
"""A limit increases an error if the error is more than this factor times the error without a
limit, and more than this difference (degrees or mm) above it."""
LAGS = (-0.03, 0.4)
"""Range (s) in which the lag is searched."""
LOST = 30.0
"""Error (degrees or mm) from which a hand no longer follows, so that its lag has no meaning."""
CHECKED_POSES = 50
SCANNED_TIMESTEP = 0.002
"""Timestep (s) of our hand when limits are tried: that of the sandbox."""

Play = tuple[Array, Array, Array, float]
"""Poses (T, 48) at the end of every command's time; forces (n, 3) and torques (n, 15, 3) of all
steps; duration (s) of a step."""


@dataclass(frozen=True)
class Use:
    """Largest use of a group of servos.

    Attributes:
        impulse: Largest impulse (N s or N m s) of a servo in 1/60 s, as Bullet counts it.
        peak: Largest force of a servo times 1/60 s. A limit below this value changes the motion.
    """

    impulse: float
    peak: float

    def __str__(self) -> str:
        return f"{self.impulse:.2g}, {self.peak:.2g}"


@dataclass(frozen=True)
class Row:
    """Result of one hand that followed a motion.

    Attributes:
        joint_rms, joint_max: Errors of the ball joints (degrees): root mean square, and largest.
        root_rms, root_turn_rms: Root mean square errors of the root's position (mm) and rotation
            (degrees).
        joint_lag, root_lag: Lags (ms) of the joints and of the root's position.
        root, turn, joint: Use in 1/60 s of the slides (N s), of the root's rotation and of the
            joints (N m s).
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

    @property
    def peaks(self) -> tuple[float, float, float]:
        """Smallest limits (N s, N m s, N m s) that slides, root's rotation and joints do not
        reach."""
        return self.root.peak, self.turn.peak, self.joint.peak

    def __str__(self) -> str:
        return (
            f"{self.joint_rms:.3f} ({self.joint_max:.2f}) | {self.root_rms:.3f} "
            f"| {self.root_turn_rms:.3f} | {self.joint_lag:z.1f}, {self.root_lag:z.1f} "
            f"| {self.root.impulse:.2g} | {self.turn.impulse:.2g} | {self.joint.impulse:.2g} "
            f"| {', '.join(f'{peak:.2g}' for peak in self.peaks)} |"
        )


HEADER = (
    "joints rms (max), deg | root rms, mm | root rms, deg | lag of fingers, root, ms "
    "| root used, N s | its turn, N m s | a joint, N m s "
    "| largest force or torque of the three x 1/60 s |"
)


def trajectory(seed: int = SEED, period: float = CONTROL_PERIOD) -> Array:
    """Draws commands (T, 48), one every `period` seconds."""
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


def use(force: Array, timestep: float) -> Use:
    """Computes the use of n servos from their forces (T, n, 1) in N or torques (T, n, 3) in N m."""
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


def ours(commands: Array, hand: Hand, timestep: float) -> Play:
    """Lets our hand follow commands (T, 48)."""
    scene = Scene(SceneSpec((hand,), timestep=timestep))
    data = mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, commands[0])
    # 1/60 s is not a whole number of our steps: a command takes effect at the step nearest to it.
    starts = np.round(np.arange(len(commands) + 1) / (RATE * timestep)).astype(int)
    poses, forces = [], []
    for command, start, end in zip(commands, starts[:-1], starts[1:], strict=True):
        data.ctrl[:] = command
        for _ in range(start, end):
            mujoco.mj_step(scene.model, data)
            forces.append(data.actuator_force.copy())
        turns = quaternion_log(data.qpos[3:].reshape(15, 4)).ravel()
        poses.append(np.concatenate([data.qpos[:3], turns]))
    force = np.array(forces)
    return np.array(poses), force[:, :3], force[:, 3:].reshape(-1, 15, 3), timestep


def bullets(
    commands: Array, hand: Hand, rate: int, gain: float, loaded: bool = True, erp: float = 1.0
) -> Play:
    """Lets Bullet's hand follow commands (T, 48). See `BulletHand` for the options."""
    bullet = BulletHand(hand, rate, gain, loaded, erp)
    bullet.place(commands[0])
    steps = []
    for command in commands:
        bullet.command(command)
        steps += [bullet.step() for _ in range(rate // RATE)]
    poses, slides, turns = (np.array(part) for part in zip(*steps, strict=True))
    return poses[rate // RATE - 1 :: rate // RATE], slides, turns, 1.0 / rate


def compare(commands: Array, play: Play) -> Row:
    """Compares a hand's motion with its commands (T, 48)."""
    poses, slides, turns, timestep = play
    joint = np.rad2deg(
        geodesic_angle(poses[:, JOINTS].reshape(-1, 14, 3), commands[:, JOINTS].reshape(-1, 14, 3))
    )
    turn = np.rad2deg(geodesic_angle(poses[:, ROOT_ROTATION], commands[:, ROOT_ROTATION]))
    place = 1000.0 * np.linalg.norm((poses - commands)[:, ROOT_POSITION], axis=1)
    return Row(
        _rms(joint),
        float(joint.max()),
        _rms(place),
        _rms(turn),
        lag(poses[:, JOINTS], commands[:, JOINTS]) if _rms(joint) < LOST else np.inf,
        lag(poses[:, ROOT_POSITION], commands[:, ROOT_POSITION]) if _rms(place) < LOST else np.inf,
        use(slides[:, :, None], timestep),
        use(turns[:, :1], timestep),
        use(turns[:, 1:], timestep),
    )


def lag(followed: Array, commands: Array) -> float:
    """Returns the delay (ms) of values (T, k) after smooth commands (T, k), to about 0.1 ms.

    It is infinite if the best delay is at the edge of `LAGS`.
    """
    times = np.arange(len(commands)) / RATE
    path = CubicSpline(times, commands, axis=0)
    inside = (times > LAGS[1]) & (times < times[-1] + LAGS[0])
    shifts = np.arange(LAGS[0], LAGS[1], 1e-3)
    costs = [np.mean((followed[inside] - path(times[inside] - s)) ** 2) for s in shifts]
    best = int(np.argmin(costs))
    if not 0 < best < len(shifts) - 1:
        return np.inf
    # The lowest point of a parabola through the best shift and its neighbours.
    left, middle, right = costs[best - 1 : best + 2]
    part = 0.5 * (left - right) / (left - 2.0 * middle + right)
    return 1000.0 * float(shifts[best] + 1e-3 * part)


def farthest_joint(commands: Array) -> float:
    """Returns the largest distance (m) between joints of Bullet's hand and ours, over poses of the
    commands."""
    bullet = BulletHand(Hand(), RATES[-1])
    apart = 0.0
    for q in commands[:: len(commands) // CHECKED_POSES]:
        bullet.place(q)
        apart = max(apart, float(np.abs(bullet.joints() - Kinematics(ADULT).place(q).joints).max()))
    return apart


def print_search(commands: Array, hand: Hand, late: float) -> tuple[int, float]:
    """Prints a row for each rate and gain of Bullet's motors.

    Args:
        commands: (T, 48) commanded poses.
        hand: The hand.
        late: Lag (ms) of our fingers. The row with the nearest lag is marked too.

    Returns:
        Rate and gain with the smallest error of the joints.
    """
    rows = {
        (rate, gain): compare(commands, bullets(commands, hand, rate, gain))
        for rate in RATES
        for gain in GAINS
    }
    best = min(rows, key=lambda key: rows[key].joint_rms)
    same = min(rows, key=lambda key: abs(rows[key].joint_lag - late))
    marks = {best: " **best**", same: " **as late as ours**"}
    _print_header("Bullet, steps a second", "gain")
    for (rate, gain), row in rows.items():
        print(f"| {rate} | {gain:g}{marks.get((rate, gain), '')} | {row}")
    bare = compare(commands, bullets(commands, hand, *best, loaded=False))
    print(f"| {best[0]} | {best[1]:g}, no armature at the fingers | {bare}", flush=True)
    row = compare(commands, bullets(commands, hand, RATES[0], 1.0, erp=DEFAULT_ERP))
    print(f"| {RATES[0]} | 1, `erp` {DEFAULT_ERP:g} | {row}", flush=True)
    return best


def print_scan(name: str, play: Callable[[float], Row]) -> None:
    """Prints how a hand follows with smaller limits, and from which limit on its errors increase.

    Args:
        name: Name of the hand.
        play: Returns the result with a limit in N s (N m s).
    """
    rows = {limit: play(limit) for limit in LIMITS}
    free = rows[LIMITS[0]]
    _print_header(f"{name}: limit, N s")
    for limit, row in rows.items():
        print(f"| {limit:g} | {row}", flush=True)
    parts = zip(
        ("slides", "turn", "joints"),
        ("root_rms", "root_turn_rms", "joint_rms"),
        free.peaks,
        strict=True,
    )
    for part, error, peak in parts:
        wanted = getattr(free, error)
        most = max(COSTS * wanted, wanted + LEAST_COST)
        costly = next((j for j in LIMITS if getattr(rows[j], error) > most), None)
        print(f"{part}: a limit below {peak:.2g} is reached, and it costs something at {costly}")


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=SEED, help="seed of the movements")
    args = parser.parse_args()
    commands = trajectory(args.seed, 1.0 / RATE)
    hand = Hand()
    print(describe_machine())
    print(
        f"{len(commands)} commands at {RATE} Hz, seed {args.seed}; limit {hand.impulse:g} N s "
        f"(N m s) per 1/60 s, which is {hand.force_limit:g} N (N m)"
    )
    apart = 1e6 * farthest_joint(commands)
    print(f"Bullet's joints lie within {apart:.2g} um of ours in the same poses")
    _print_header("ours, servo", "step, ms")
    late = np.nan
    for servo in SERVOS:
        for timestep in TIMESTEPS:
            row = compare(commands, ours(commands, replace(hand, servo=servo), timestep))
            if servo == hand.servo and timestep == SCANNED_TIMESTEP:
                late = row.joint_lag
            print(f"| {servo} | {1000 * timestep:g} | {row}", flush=True)
    rate, gain = print_search(commands, hand, late)

    def of_bullet(limit: float) -> Row:
        return compare(commands, bullets(commands, replace(hand, impulse=limit), rate, gain))

    print_scan(f"Bullet, {rate} steps a second, gain {gain:g}", of_bullet)
    for servo in SERVOS:

        def of_ours(limit: float, servo: str = servo) -> Row:
            limited = replace(hand, servo=servo, impulse=limit)
            return compare(commands, ours(commands, limited, SCANNED_TIMESTEP))

        print_scan(f"ours, {servo}, {1000 * SCANNED_TIMESTEP:g} ms", of_ours)


def _print_header(*first: str) -> None:
    print(f"\n| {' | '.join(first)} | {HEADER}")
    print("|" + " --- |" * (len(first) + HEADER.count("|")))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


if __name__ == "__main__":
    main()
