"""Simulates the second subject: the takes of a day become one capture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from models.arithmetic import Array
from models.errors import InputError
from models.frames import FINGERS
from models.surface import Surface
from training.second_subject.configuration import SecondConfiguration
from training.second_subject.contacts import (
    TakeSettings,
    closeness,
    contact_ids,
    free_play,
    preferences,
    script,
)
from training.second_subject.grips import (
    MANNERS,
    clamped,
    keyframes,
    knots,
    path,
    with_manner,
)
from training.second_subject.hand import SLENDER, SecondHand
from training.second_subject.measurement import Markers, touches
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
