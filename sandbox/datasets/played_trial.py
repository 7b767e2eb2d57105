"""A demonstration: a recorded trial, played through the Gymnasium environment of its task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from models.arithmetic import Array
from models.errors import InputError, RecordingError
from models.frames import FINGERS, Contact, TouchFrame
from models.plugins import place_file
from models.scene import CONTROL_PERIOD
from sandbox.gym.environment import HandSandboxEnv
from sandbox.gym.environment_options import TRUE_LABELS
from sandbox.recording.recorded_task import task_change
from sandbox.recording.recording import Recording, load_recording
from sandbox.recording.versions import check_states
from sandbox.trial.replay import settings_of, versions_of
from sandbox.trial.settings import encoded, recorded_settings, recorded_users
from tasks.registry import TASK_PLUGINS, find_task
from tasks.variation import TOUCHES

SLOTS = len(FINGERS)


@dataclass
class Touch:
    """One touch from its beginning to its end.

    Attributes:
        number: Its index in the list of all touches of a hand.
        first: Control period in which it begins.
        places: (x, y), m on the surface, for each of its control periods.
        finger: Its finger, reported by the device or found by the labeller; None if unknown.
    """

    number: int
    first: int
    places: list[tuple[float, float]] = field(default_factory=list)
    finger: int | None = None

    @property
    def end(self) -> int:
        """The first control period after the touch."""
        return self.first + len(self.places)


def touches_of(frames: Sequence[Sequence[Contact]]) -> list[Touch]:
    """All touches of a hand, in the order in which they begin.

    Between two touches, a slot must be empty for at least one period; otherwise they would be a
    single touch. If more than five touches are down at the same time, a further touch begins as
    soon as a slot is free. It is left out if no slot becomes free while it is down.

    Args:
        frames: The contacts of every control period.
    """
    touches: list[Touch] = []
    here: dict[int, Touch] = {}
    for period, contacts in enumerate(frames):
        known = {contact.id: contact for contact in contacts}
        # A slot that has just become empty is not free yet.
        busy = len(here)
        here = {id: touch for id, touch in here.items() if id in known}
        for id, contact in known.items():
            if id not in here:
                if busy >= SLOTS:
                    continue
                busy += 1
                here[id] = Touch(len(touches), period, finger=contact.label)
                touches.append(here[id])
            here[id].places.append((contact.x, contact.y))
    return touches


def slots_of(touches: Sequence[Touch]) -> list[int]:
    """A slot for every touch: the slot of its finger if this slot is free, else another slot."""
    free_from = [0] * SLOTS
    slots = []
    for touch in touches:
        free = [slot for slot in range(SLOTS) if free_from[slot] <= touch.first]
        slot = touch.finger if touch.finger in free else _last_choice(free, touches, touch)
        # The slot stays empty for one period between two touches.
        free_from[slot] = touch.end + 1
        slots.append(slot)
    return slots


def _last_choice(free: Sequence[int], touches: Sequence[Touch], touch: Touch) -> int:
    """A free slot; if possible, the slot of a finger that no simultaneous touch has."""
    beside = {t.finger for t in touches if t.first < touch.end and touch.first <= t.end}
    return next((slot for slot in free if slot not in beside), free[0])


def actions_of(
    touches: Sequence[Touch], slots: Sequence[int], lifts: Sequence[float] | None, periods: int
) -> Array:
    """Actions (periods, 15) of `TouchHands`, or (periods, 16) with a lift control.

    Args:
        touches: The touches of a hand.
        slots: The slot of each touch.
        lifts: Position of the lift control in every period; None without a lift control.
        periods: Number of control periods.
    """
    actions = np.zeros((periods, 3 * SLOTS + (lifts is not None)))
    for touch, slot in zip(touches, slots, strict=True):
        places = touch.places[: max(0, periods - touch.first)]
        if places:
            rows = slice(touch.first, touch.first + len(places))
            actions[rows, 3 * slot] = 1.0
            actions[rows, 3 * slot + 1 : 3 * slot + 3] = places
    if lifts is not None:
        actions[:, -1] = lifts[:periods]
    return actions


def labelled(touches: Sequence[Touch], found: Mapping[int, int]) -> list[Touch]:
    """The touches with the fingers that the labeller found.

    Args:
        touches: The touches of a hand.
        found: Finger by the touch's number.
    """
    return [Touch(t.number, t.first, t.places, found.get(t.number, t.finger)) for t in touches]


@dataclass(frozen=True)
class Demonstration:
    """One episode; T steps of 16 ms.

    Attributes:
        seed: Seed of the trial.
        observations: Name -> (T + 1, ...) observations; the first one is from before the first
            step.
        actions: (T, n) actions.
        rewards: (T,) rewards.
        terminated: True if the task ended the episode.
        truncated: True if the time limit or the end of the recording ended the episode.
        hashes: (T + 1) hashes of the states.
        about: Source and outcome of the episode; JSON values (see docs/data-sets.md).
    """

    seed: int
    observations: dict[str, Array]
    actions: Array
    rewards: Array
    terminated: bool
    truncated: bool
    hashes: tuple[str, ...]
    about: dict[str, Any]

    @property
    def success(self) -> bool:
        """True if the goal was held."""
        return bool(self.about["success"])


def open_demonstration(path: Path) -> Recording:
    """Reads a recording that can become a demonstration.

    Raises:
        DifferentStatesError: The recording was made with other `STATES`.
        RecordingError: The recording has no end, is damaged, has no versions, or is of a hand in
            the air.
    """
    recording = load_recording(path)
    check_states(recording)
    if recording.damage or recording.end is None:
        raise RecordingError(
            "a demonstration needs a complete recording",
            where=str(path),
            got=recording.damage or "a recording without an end",
            remedy="Leave this recording out",
        )
    versions_of(recording)
    for hand in recording.inputs:
        recording.touches(hand)
    return recording


def broken_off(recording: Recording) -> bool:
    """True if a recording is of a study's attempt that was ended early and does not count."""
    return recording.end is not None and bool(recording.end["result"].get("broken_off"))


def environment_of(recording: Recording, observe: Sequence[str]) -> tuple[str, dict[str, Any]]:
    """The environment that plays a recording: its task, and its options as JSON values.

    Recordings can be in the same data set if their environments are equal.

    Args:
        recording: The recording.
        observe: Parts of observations, or `all` alone.

    Raises:
        RecordingError: The recorded task, encoder or robot is not on this machine.
    """
    settings = encoded(settings_of(recording))
    task = _from_anywhere(settings.pop("task"))
    del settings["seed"]
    # Recorded touches already contain the disturbances of the variation.
    settings["variation"] |= dict.fromkeys(TOUCHES, 0.0)
    # The agent replaces the recorded devices.
    for device in ("device", "second_device"):
        del settings[device]
    options: dict[str, Any] = {
        "action": "touch",
        "reward": "progress",
        "observe": "all" if tuple(observe) == ("all",) else list(observe),
        "settings": settings,
    }
    contacts = _contacts(recording)
    if contacts and all(contact.label is not None for contact in contacts):
        options["labels"] = TRUE_LABELS
    return task, options


def _from_anywhere(task: str) -> str:
    """The place of a task with the absolute path of its file; the name of any other task."""
    file = place_file(task)
    return task if file is None else f"{file}:{TASK_PLUGINS.member_at(task)}"


def changed_task(recording: Recording) -> str:
    """A line on changes of a recording's external task since the recording; empty without changes.

    Raises:
        RecordingError: The recorded task, encoder or robot is not on this machine.
    """
    settings = settings_of(recording)
    return task_change(recording.header, settings.task, settings.seed, settings.surface.rectangle)


def demonstrate(recording: Recording, env: HandSandboxEnv) -> Demonstration:
    """Plays a recording's touches through an environment that has the recording's options.

    While the recording is played, touches get slots in the order in which they begin. In the
    returned actions, touches are in the slots of their fingers. States do not depend on slots, so
    that these actions give the same states.

    Raises:
        RecordingError: A hand of the recording has no touches.
    """
    assert recording.end is not None
    hands = len(env.settings.hands)
    period = round(CONTROL_PERIOD / env.settings.physics.timestep)
    periods = int(recording.end["step"]) // period
    frames = [_frames(recording, hand, periods, period) for hand in range(hands)]
    lifted = find_task(env.settings.task).lift_range > 0
    lifts = [[f.lift or 0.0 for f in own] if lifted else None for own in frames]
    touches = [touches_of([f.contacts for f in own]) for own in frames]
    slots = [_slots_of_arrival(own) for own in touches]
    space = env.action_space
    from gymnasium.spaces import Box

    assert isinstance(space, Box)
    first = np.clip(_actions(touches, slots, lifts, periods), space.low, space.high)
    seed = recorded_settings(recording.header, "seed").seed
    seen, info = env.reset(seed=seed)
    observed, rewards, hashes = [seen], [], [info["state_hash"]]
    fingers: list[dict[int, int]] = [{} for _ in range(hands)]
    terminated = truncated = False
    same = recording.hashes.get(0, info["state_hash"]) == info["state_hash"]
    for k, action in enumerate(first):
        seen, reward, terminated, truncated, info = env.step(action)
        observed.append(seen)
        rewards.append(reward)
        hashes.append(info["state_hash"])
        same &= recording.hashes.get((k + 1) * period, hashes[-1]) == hashes[-1]
        _note_fingers(env, touches, slots, k, fingers)
        if terminated or truncated:
            break
    taken = len(rewards)
    by_finger = [labelled(own, found) for own, found in zip(touches, fingers, strict=True)]
    moved = [slots_of(own) for own in by_finger]
    actions = np.clip(_actions(by_finger, moved, lifts, taken), space.low, space.high)
    shown = {name: np.array([each[name] for each in observed]) for name in seen}
    for name in {"touches", "labels"} & shown.keys():
        shown[name] = _in_slots(shown[name], touches, slots, moved)
    return Demonstration(
        seed,
        shown,
        actions,
        np.array(rewards),
        terminated,
        # True if the recording ended before the task: a person gave up, or the input ended.
        truncated or not terminated,
        tuple(hashes),
        _about(recording, bool(info["success"]), same and taken == periods),
    )


def _frames(recording: Recording, hand: int, periods: int, period: int) -> list[TouchFrame]:
    """The frame of a hand in every control period."""
    frames, last = [], TouchFrame(0.0)
    inputs = iter(recording.inputs.get(hand, ()))
    coming = next(inputs, None)
    for k in range(periods):
        while coming is not None and coming.step <= k * period:
            assert isinstance(coming.frame, TouchFrame)
            last, coming = coming.frame, next(inputs, None)
        frames.append(last)
    return frames


def _contacts(recording: Recording) -> list[Contact]:
    return [c for hand in recording.inputs for f in recording.touches(hand) for c in f.contacts]


def _slots_of_arrival(touches: Sequence[Touch]) -> list[int]:
    nameless = [Touch(t.number, t.first, t.places) for t in touches]
    fingers = [t.finger for t in touches]
    return slots_of(touches if None not in fingers else nameless)


def _actions(
    touches: Sequence[Sequence[Touch]],
    slots: Sequence[Sequence[int]],
    lifts: Sequence[Sequence[float] | None],
    periods: int,
) -> Array:
    """Actions of all hands, side by side."""
    each = zip(touches, slots, lifts, strict=True)
    return np.concatenate([actions_of(*own, periods) for own in each], axis=1)


def _in_slots(
    values: Array,
    touches: Sequence[Sequence[Touch]],
    before: Sequence[Sequence[int]],
    after: Sequence[Sequence[int]],
) -> Array:
    """Moves touches to other slots in observations (T + 1, 5, ...), or (T + 1, hands, 5, ...).

    Args:
        values: The observations.
        touches: Touches of each hand.
        before: Slots of the touches in the observations.
        after: New slots of the touches.
    """
    hands = len(touches)
    old = values if hands > 1 else values[:, None]
    # An empty slot has the values that it has before the first step.
    new = np.repeat(old[:1], len(old), axis=0)
    for hand in range(hands):
        for touch, a, b in zip(touches[hand], before[hand], after[hand], strict=True):
            # The touch of a step appears in the observation after this step.
            seen = slice(touch.first + 1, touch.end + 1)
            new[seen, hand, b] = old[seen, hand, a]
    return new if hands > 1 else new[:, 0]


def _note_fingers(
    env: HandSandboxEnv,
    touches: Sequence[Sequence[Touch]],
    slots: Sequence[Sequence[int]],
    k: int,
    fingers: Sequence[dict[int, int]],
) -> None:
    """Stores the labels of the touches of control period `k` in `fingers`."""
    for hand, labels in enumerate(env.slot_labels()):
        for touch, slot in zip(touches[hand], slots[hand], strict=True):
            finger = labels[slot]
            if touch.first <= k < touch.end and finger is not None:
                fingers[hand][touch.number] = finger


def _about(recording: Recording, success: bool, same: bool) -> dict[str, Any]:
    header, end = recording.header, recording.end
    assert end is not None
    user = recorded_users(header)[0]
    return {
        "source": recording.path.name,
        "success": success,
        "simulated": user is not None,
        "device": recorded_settings(header, "device").device.name,
        "user": None if user is None else asdict(user),
        "same_states_as_recorded": same,
        "recorded_success": bool(end["result"]["success"]),
        "recorded_state_hash": str(end["hash"]),
        "versions": versions_of(recording),
        "digests": header.get("digests", {}),
    }


def check_equal(
    first: tuple[str, dict[str, Any]], other: tuple[str, dict[str, Any]], where: str
) -> None:
    """Checks that two recordings have the same environment.

    Args:
        first: Result of `environment_of` for the first recording.
        other: Result of `environment_of` for the other recording.
        where: File of the other recording, for error messages.

    Raises:
        InputError: Tasks or options differ.
    """
    theirs = _flat(*other)
    for name, value in _flat(*first).items():
        if (got := theirs.get(name)) != value:
            raise InputError(
                "recordings of one data set must have equal tasks and settings",
                where=where,
                got=f"{name} {got}",
                expected=f"{value}, as the first recording",
                remedy="Export this recording as a data set of its own",
            )


def _flat(task: str, options: dict[str, Any]) -> dict[str, Any]:
    settings = {f"settings.{name}": value for name, value in options["settings"].items()}
    own = {"task": task, "labels": None, **options, **settings}
    return {**own, "settings": sorted(options["settings"])}
