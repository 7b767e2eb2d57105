"""Simulates the second subject: the takes of a day become one capture.

A take has finger sets over time: the script of day 0, or the free play of later days. A simulated
screen measures the touches, and simulated markers measure the poses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from models.arithmetic import Array, Mask
from models.errors import InputError
from models.frames import FINGERS
from models.pose import BALL_JOINTS, JOINTS, ROOT_POSITION, ROOT_ROTATION
from models.surface import Surface
from training.second_subject.configuration import SecondConfiguration
from training.second_subject.grips import (
    GESTURES,
    MANNERS,
    clamped,
    keyframes,
    knots,
    path,
    with_manner,
)
from training.second_subject.hand import SLENDER, SecondHand
from training.second_subject.placing import MovementPlan, place

_PERSON, _DAY, _PLAY, _TAKE, _SENSORS = range(11, 16)
"""Purposes of random numbers. Each has its own random stream."""

_PAUSE = 3.0
"""Time (s) between two takes."""


@dataclass(frozen=True)
class _SubjectDay:
    """Constants of one day: the subject's habits, and the position of its elbow on that day."""

    taste: Array
    coupling: Array
    lift: Array
    curl: NDArray[np.bool_]
    lean: Array
    elbow: Array


def simulate(
    configuration: SecondConfiguration,
    seed: int,
    day: int,
    progress: Callable[[float], None] | None = None,
    hand: SecondHand = SLENDER,
    lean: Array | None = None,
) -> Capture:
    """Captures a second simulated subject.

    Args:
        configuration: Settings of second subjects.
        seed: Seed of the subject: its preferences, habits and all its actions.
        day: 0 plays the training script, every later day is free play. Marker positions are drawn
            again for every day.
        progress: Called with the share done, 0 to 1.
        hand: The subject's hand.
        lean: (13,) constant part of the subject's manner, in the order of `grips.MANNERS` and in
            units of the habits' spread; None for 0.

    Returns:
        The capture; equal arguments give equal captures. `meta["simulated"]` is True.

    Raises:
        InputError: Seed or day is negative.
    """
    for name, value in (("seed", seed), ("day", day)):
        if value < 0:
            raise InputError(f"the {name} is out of range", got=value, expected="0 or more")
    c, surface = configuration, Surface()
    person = _person(seed, day, c, surface, lean)
    play = np.random.default_rng([_PLAY, seed, day])
    takes = free_play(play, person.taste, c) if day else script(c)
    # Day 0 is shuffled, too: habits drift, and would otherwise correlate with the script.
    takes = [takes[i] for i in play.permutation(len(takes))]
    habits = _drift(play, len(takes), c)
    wishes = []
    for number, take in enumerate(takes):
        rng = np.random.default_rng([_TAKE, seed, day, number])
        wishes.append(_plan(rng, take, habits[number], person, hand, surface, c))
        if progress:
            progress(0.3 * (number + 1) / len(takes))
    plan = MovementPlan.joined(wishes)
    root, turn, angles = place(plan, hand, surface, c)
    if progress:
        progress(0.8)

    numbers = np.repeat(np.arange(len(takes)), [len(t.down) for t in takes])
    q = hand.pose(root, turn, angles)
    _, rotations, tips = hand.chain(q)
    sensors = np.random.default_rng([_SENSORS, seed, day])
    along = rotations[:, hand.last_bone][..., 1]
    xy = touches(sensors, tips, along, numbers, takes[0].rate, surface, c)
    measured = Markers(sensors, hand, c).poses(sensors, q)
    down = np.concatenate([t.down for t in takes])
    ids, times, clock, free = [], [], 0.0, 0
    for take in takes:
        of_take, free = contact_ids(take.down, free)
        ids.append(of_take)
        times.append(clock + take.times)
        clock += take.times[-1] + _PAUSE
    if progress:
        progress(1.0)
    meta = {
        "simulated": True,
        "subject": f"second simulated {seed}",
        "seed": seed,
        "day": day,
        "side": "right",
        "skeleton": hand.name,
        "surface_in": [surface.width_in, surface.height_in],
        "rate_hz": takes[0].rate,
        "configuration": c.as_json(),
    }
    xy = np.where(down[..., None], xy, np.nan)
    return Capture(np.concatenate(times), numbers, np.concatenate(ids), xy, measured, meta)


def _person(
    seed: int, day: int, c: SecondConfiguration, surface: Surface, lean: Array | None
) -> _SubjectDay:
    always = np.random.default_rng([_PERSON, seed])
    taste = preferences(always, c.taste)
    coupling = always.uniform(*c.coupling, len(FINGERS))
    lift = always.uniform(*c.raise_, len(FINGERS))
    curl = always.random(len(FINGERS)) < c.curl
    elbow = np.array([surface.size[0] / 2 + 0.06, -surface.size[1] - c.elbow])
    lean = np.zeros(len(MANNERS)) if lean is None else lean
    if day:
        today = np.random.default_rng([_DAY, seed, day])
        lean = lean + c.day_manner * today.uniform(-1, 1, len(MANNERS))
        elbow = elbow + c.day_elbow * today.uniform(-1.7, 1.7, 2)
    return _SubjectDay(taste, coupling, lift, curl, lean, elbow)


def _drift(rng: np.random.Generator, count: int, c: SecondConfiguration) -> Array:
    """Habits (count, manners) of takes in -1 to 1: a random walk that is reflected at both ends."""
    steps = c.drift * rng.uniform(-1, 1, (count, len(MANNERS)))
    walk = rng.uniform(-1, 1, len(MANNERS)) + np.cumsum(steps, axis=0)
    return np.asarray(np.abs((walk + 1) % 4 - 2) - 1)


def _plan(
    rng: np.random.Generator,
    take: TakeSettings,
    habit: Array,
    person: _SubjectDay,
    hand: SecondHand,
    surface: Surface,
    c: SecondConfiguration,
) -> MovementPlan:
    """The intended movement of a take, before the screen is considered."""
    times = take.times
    calm = c.calm if take.free else 1.0
    moments = knots(rng, float(times[-1]), c.pace)
    shapes, tilts = zip(*(keyframes(rng, moments, g, calm, c) for g in take.gestures), strict=True)
    # Two gestures alternate, keyframe by keyframe.
    pick = np.arange(len(moments)) % len(take.gestures)
    rows = np.arange(len(moments))
    angles = path(times, moments, np.array(shapes)[pick, rows])
    tilt = path(times, moments, np.array(tilts)[pick, rows])
    change = np.clip(rng.standard_t(c.tail, (len(moments), len(MANNERS))), -3, 3)
    manner = np.array(c.habit) * (habit + person.lean) + np.array(c.variety) * change
    manner = path(times, moments, manner)
    angles = clamped(with_manner(angles, manner), hand)

    middle = _way(rng, times, take, calm, surface, c)
    arm = middle - person.elbow
    forearm = np.arctan2(-arm[:, 0], arm[:, 1])
    yaw = _yaw(rng, times, take, calm, c) + c.forearm * forearm
    down = take.down
    return MovementPlan(
        angles=angles,
        yaw=yaw,
        pitch=tilt + manner[:, 10],
        roll=manner[:, 11],
        height=manner[:, 12],
        middle=middle,
        used=np.broadcast_to(down.any(axis=0), down.shape),
        close=closeness(down, take.rate, c.landing),
        lift=np.broadcast_to(person.lift * rng.uniform(*c.lift_variety, len(FINGERS)), down.shape),
        curl=np.broadcast_to(person.curl, down.shape),
        coupling=np.broadcast_to(person.coupling, down.shape),
    )


def _way(
    rng: np.random.Generator,
    times: Array,
    take: TakeSettings,
    calm: float,
    surface: Surface,
    c: SecondConfiguration,
) -> Array:
    """Path (n, 2) m of the middle of the fingertips, 3-D surface frame."""
    centre = surface.size / 2 * [1, -1]
    moments = knots(rng, float(times[-1]), c.pace)
    field = np.array(c.way)
    far = 1.0 if "move" in take.gestures else 0.25
    home = (1 - far) * field * rng.uniform(-1, 1, 2)
    steps = calm * far * field * rng.uniform(-1, 1, (len(moments), 2))
    return np.asarray(centre + home + path(times, moments, steps))


def _yaw(
    rng: np.random.Generator, times: Array, take: TakeSettings, calm: float, c: SecondConfiguration
) -> Array:
    """Yaw (n,) rad: to and fro in a take with turning, otherwise nearly constant."""
    moments = knots(rng, float(times[-1]), c.pace)
    if "rotate" in take.gestures:
        low, high = calm * np.array(c.turn)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        sides = (-1.0) ** (np.arange(len(moments)) + rng.integers(2))
        values = middle + half * sides * rng.uniform(0.3, 1.0, len(moments))
    else:
        values = calm * c.bias * rng.uniform(-1, 1) + 0.12 * calm * rng.laplace(0, 1, len(moments))
    return path(times, moments, values)


SETS = np.array(
    [[bool(code >> f & 1) for f in range(5)] for code in range(32) if code.bit_count() >= 2]
)
"""Booleans (26, 5): the fingers of each set of two or more fingers."""


@dataclass(frozen=True)
class TakeSettings:
    """Settings of one take: touching fingers (n, 5), rate in Hz, gestures, and whether it is free
    play."""

    down: Mask
    rate: float
    gestures: tuple[str, ...]
    free: bool

    @property
    def times(self) -> Array:
        """Times (n,) s from the take's beginning."""
        return np.arange(len(self.down)) / self.rate


def script(c: SecondConfiguration) -> list[TakeSettings]:
    """Script of day 0: every finger set with every gesture, so that encoders learn every set."""
    takes = []
    for size, frames in enumerate(c.training_frames, start=2):
        chosen = SETS[SETS.sum(axis=1) == size]
        repeats = c.five_finger_repeats if size == len(FINGERS) else 1
        clips = [(fingers, g) for fingers in chosen for g in GESTURES for _ in range(repeats)]
        share, rest = divmod(frames, len(clips))
        for i, (fingers, gesture) in enumerate(clips):
            down = np.repeat(fingers[None], share + (i < rest), axis=0)
            takes.append(TakeSettings(down, c.training_rate, (gesture,), False))
    return takes


def preferences(rng: np.random.Generator, scale: float) -> Array:
    """Preference (26,) of a subject for each finger set.

    All subjects prefer sets with the thumb, and sets without gaps from the index finger on. The
    logarithm of individual preferences has a Laplace distribution, so some of them are strong.
    """
    others = SETS[:, 1:]
    # Unused fingers between the index and the outermost finger in use.
    skipped = (4 - others[:, ::-1].argmax(axis=1)) - others.sum(axis=1)
    liking = np.log(2.0) * SETS[:, 0] - 0.9 * skipped
    return np.exp(liking + rng.laplace(0, scale, len(SETS)))


def free_play(rng: np.random.Generator, taste: Array, c: SecondConfiguration) -> list[TakeSettings]:
    """Takes of the free play of a later day. A take consists of stretches with one finger set each;
    from stretch to stretch, one or two fingers change."""
    stretches = _stretches(rng, taste, c)
    takes = []
    while stretches:
        current = stretches.pop(int(rng.integers(len(stretches))))
        chain = [current]
        while sum(n for _, n in chain) < c.take_length * c.test_rate:
            changes = [int((SETS[s] ^ SETS[chain[-1][0]]).sum()) for s, _ in stretches]
            near = [i for i, count in enumerate(changes) if 1 <= count <= 2]
            if not near:
                break
            chain.append(stretches.pop(int(rng.choice(near))))
        down = np.concatenate([np.repeat(SETS[s][None], n, axis=0) for s, n in chain])
        count = 1 if rng.random() < 0.4 else 2
        gestures = tuple(str(g) for g in rng.choice(GESTURES, count, replace=False))
        takes.append(TakeSettings(down, c.test_rate, gestures, True))
    return takes


def _stretches(
    rng: np.random.Generator, taste: Array, c: SecondConfiguration
) -> list[tuple[int, int]]:
    """Stretches of a day, as pairs of the index of a finger set and the number of frames.

    For every number of fingers, the frames add up to `test_frames`.
    """
    out = []
    low, high = (int(s * c.test_rate) for s in c.stay)
    for size, left in enumerate(c.test_frames, start=2):
        chosen = np.flatnonzero(SETS.sum(axis=1) == size)
        odds = taste[chosen] / taste[chosen].sum()
        while left:
            frames = int(rng.integers(low, high + 1))
            # If the remainder would be too short for a stretch, it is added to the last stretch.
            frames = left if left - frames < low else frames
            out.append((int(rng.choice(chosen, p=odds)), frames))
            left -= frames
    return out


def closeness(down: Mask, rate: float, landing: float) -> Array:
    """Values (n, 5): 1 while a finger touches, 0 while it is lifted, with smooth transitions."""
    n = len(down)
    frame = np.arange(n)[:, None]
    before = np.maximum.accumulate(np.where(down, frame, -n * 9), axis=0)
    after = np.minimum.accumulate(np.where(down, frame, n * 9)[::-1], axis=0)[::-1]
    away = np.minimum(frame - before, after - frame) / rate
    return 0.5 + 0.5 * np.cos(np.pi * np.clip(away / landing, 0.0, 1.0))


def contact_ids(down: Mask, first: int) -> tuple[NDArray[np.int64], int]:
    """Contact ids (n, 5), -1 while lifted, and the next free id.

    An id lasts from touch-down to touch-up and is never used again.
    """
    ids = np.full(down.shape, -1, np.int64)
    living = np.full(down.shape[1], -1, np.int64)
    for i, touching in enumerate(down):
        new = touching & (living < 0)
        living[new] = first + np.arange(new.sum())
        first += int(new.sum())
        living[~touching] = -1
        ids[i] = living
    return ids, first


_LAST = np.array([1, 4, 7, 10, 13])
_FIRST = np.array([0, 2, 5, 8, 11])


def touches(
    rng: np.random.Generator,
    tips: Array,
    along: Array,
    takes: NDArray[np.int64],
    rate: float,
    surface: Surface,
    c: SecondConfiguration,
) -> Array:
    """Touches (n, 5, 2) m of the fingertips as a screen reports them, x right and y down.

    Args:
        rng: Source of jitter.
        tips: (n, 5, 3) m, 3-D surface frame.
        along: (n, 5, 3) directions of the last bones.
        takes: (n,) number of the take. Jitter is not correlated between takes.
        rate: Rate (Hz) of the frames.
        surface: The screen.
        c: Sizes of errors.
    """
    # A flat finger touches with its pad, behind the tip. An upright finger touches with the tip.
    steep = np.clip(-along[..., 2], 0.0, 1.0)
    flat = along[..., :2] / np.maximum(np.linalg.norm(along[..., :2], axis=-1, keepdims=True), 1e-6)
    seen = tips[..., :2] - c.pad * ((1 - steep) ** 0.75)[..., None] * flat
    memory = c.jitter_memory ** (30.0 / rate)
    noise = c.jitter * rng.laplace(0, np.sqrt(0.5), seen.shape)
    for i in range(1, len(noise)):
        if takes[i] == takes[i - 1]:
            noise[i] = memory * noise[i - 1] + np.sqrt(1 - memory**2) * noise[i]
    seen = (seen + noise) * np.array([1.0, -1.0])
    cells = np.floor(np.clip(seen, 0.0, surface.size - c.grid) / c.grid)
    return np.asarray((cells + 0.5) * c.grid)


class Markers:
    """The markers of one day, with their errors.

    The errors are of position, not of joint angle. Each marker is a little off its joint for the
    whole day, and trembles with the skin. Measured bones go from marker to marker. So an error of
    one marker rotates the two bones that meet there in opposite directions, and short bones more
    than long bones.

    Args:
        rng: Source of the markers' errors.
        hand: The hand that wears them.
        c: Sizes of errors.
    """

    def __init__(self, rng: np.random.Generator, hand: SecondHand, c: SecondConfiguration) -> None:
        self._hand, self._c = hand, c
        # Errors of markers at joints and fingertips, in the frames of their bones. They are uniform
        # in a box, with the standard deviation c.marker on each axis.
        self._joints = np.sqrt(3) * c.marker * rng.uniform(-1, 1, (BALL_JOINTS, 3))
        self._tips = np.sqrt(3) * c.marker * rng.uniform(-1, 1, (5, 3))
        self._palm = np.sqrt(3) * c.palm_marker * rng.uniform(-1, 1, (3, 3))

    def poses(self, rng: np.random.Generator, q: Array) -> Array:
        """Measured poses (n, 48) for true poses (n, 48), limited to the ranges of the joints."""
        from scipy.spatial.transform import Rotation

        hand, c, n = self._hand, self._c, len(q)

        def tremble(count: int) -> Array:
            return rng.laplace(0, c.tremble / np.sqrt(2), (n, count, 3))

        places, rotations, tips = hand.chain(q)
        places = places + (rotations @ self._joints[..., None])[..., 0] + tremble(BALL_JOINTS)
        tips = tips + (rotations[:, _LAST] @ self._tips[..., None])[..., 0] + tremble(5)
        ends = np.empty_like(places)
        ends[:, :-1] = places[:, 1:]
        ends[:, _LAST] = tips
        seen = _onto(rotations, ends - places)

        root = Rotation.from_rotvec(q[:, ROOT_ROTATION]).as_matrix()
        wrist, index, little = np.swapaxes(self._palm + tremble(3), 0, 1)
        # Small apparent rotations of the palm, caused by errors of its three markers.
        length, width = hand.knuckle[2, 1], hand.knuckle[4, 0] - hand.knuckle[1, 0]
        middle = 0.5 * (index + little)
        lean = np.stack(
            [
                (middle - wrist)[:, 2] / length,
                (index - little)[:, 2] / width,
                (wrist - middle)[:, 0] / length,
            ],
            axis=-1,
        )
        palm = root @ Rotation.from_rotvec(lean).as_matrix()
        out = q.copy()
        out[:, ROOT_POSITION] += (root @ wrist[..., None])[..., 0]
        out[:, ROOT_ROTATION] = Rotation.from_matrix(palm).as_rotvec()
        before = np.empty_like(seen)
        before[:, 1:] = seen[:, :-1]
        before[:, _FIRST] = palm[:, None]
        relative = _between(before, seen, hand)
        lower, upper = hand.joint_limits()
        vectors = Rotation.from_matrix(relative.reshape(-1, 3, 3)).as_rotvec().reshape(n, -1)
        out[:, JOINTS] = np.clip(vectors, lower, upper)
        return out


def _onto(rotations: Array, lines: Array) -> Array:
    """Rotates frames (..., 3, 3) by the smallest angle with which their y axes point along lines
    (..., 3)."""
    y = rotations[..., 1]
    goal = lines / np.linalg.norm(lines, axis=-1, keepdims=True)
    axis = np.cross(y, goal)
    share = 1 / (1 + (y * goal).sum(axis=-1))
    # R = I + K + K^2 / (1 + y.goal), applied to each column: K a = axis x a.
    columns = np.swapaxes(rotations, -1, -2)
    once = np.cross(axis[..., None, :], columns)
    twice = np.cross(axis[..., None, :], once)
    return np.swapaxes(columns + once + share[..., None, None] * twice, -1, -2)


def _between(before: Array, after: Array, hand: SecondHand) -> Array:
    """Joint rotations (n, 14, 3, 3) from the parent bones (n, 14, 3, 3) to their children."""
    rest = hand.rests()
    return np.swapaxes(before @ rest, -1, -2) @ after
