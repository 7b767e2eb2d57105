"""A demonstration: a recorded trial, played through the environment that others learn in."""

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
        number: Its place in the list of all touches of a hand.
        first: Control period in which it begins.
        places: (x, y) m on the surface, period by period.
        finger: Its finger, if the device said it or once it is found out; None otherwise.
    """

    number: int
    first: int
    places: list[tuple[float, float]] = field(default_factory=list)
    finger: int | None = None

    @property
    def end(self) -> int:
        """The control period after its last one."""
        return self.first + len(self.places)


def touches_of(frames: Sequence[Sequence[Contact]]) -> list[Touch]:
    """All touches of a hand, in the order in which they begin.

    A slot is empty for one period at least between two touches, or they would be one. With more
    than five at a time, a touch begins as soon as there is a slot for it, or is left out.

    Args:
        frames: The contacts of every control period.
    """
    touches: list[Touch] = []
    here: dict[int, Touch] = {}
    for period, contacts in enumerate(frames):
        known = {contact.id: contact for contact in contacts}
        # Slots that have just become empty are not free yet.
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
    """A slot for every touch: that of its finger if it is free, and another one otherwise."""
    free_from = [0] * SLOTS
    slots = []
    for touch in touches:
        free = [slot for slot in range(SLOTS) if free_from[slot] <= touch.first]
        slot = touch.finger if touch.finger in free else _last_choice(free, touches, touch)
        # Empty for one period in between.
        free_from[slot] = touch.end + 1
        slots.append(slot)
    return slots


def _last_choice(free: Sequence[int], touches: Sequence[Touch], touch: Touch) -> int:
    """A free slot, of a finger that no touch of the same time has if there is one."""
    beside = {t.finger for t in touches if t.first < touch.end and touch.first <= t.end}
    return next((slot for slot in free if slot not in beside), free[0])


def actions_of(
    touches: Sequence[Touch], slots: Sequence[int], lifts: Sequence[float] | None, periods: int
) -> Array:
    """Actions (periods, 15) of `TouchHands`, or (periods, 16) with a lift control.

    Args:
        touches: The touches of a hand.
        slots: The slot of each.
        lifts: Position of the lift control in every period; None where there is none.
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
    """The touches with the fingers that were found, by the touch's number."""
    return [Touch(t.number, t.first, t.places, found.get(t.number, t.finger)) for t in touches]


@dataclass(frozen=True)
class Demonstration:
    """One episode; T steps of 16 ms.

    Attributes:
        seed: Seed of the trial.
        observations: Name -> (T + 1, ...) observations, the first before the first step.
        actions: (T, n) actions.
        rewards: (T,) rewards.
        terminated, truncated: Whether the task ended the episode, or something else did.
        hashes: (T + 1) hashes of the states.
        about: What is known of it; JSON values (see docs/data-sets.md).
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
        DifferentStatesError: It was made with other `STATES`, so it would be another trial.
        RecordingError: It breaks off, is damaged, says no versions, or is of a hand in the air.
    """
    recording = load_recording(path)
    check_states(recording)
    if recording.damage or recording.end is None:
        raise RecordingError(
            "a demonstration needs a whole recording",
            where=str(path),
            got=recording.damage or "it has no end",
            remedy="Leave it out",
        )
    versions_of(recording)
    for hand in recording.inputs:
        recording.touches(hand)
    return recording


def broken_off(recording: Recording) -> bool:
    """True if it is of an attempt of a study that was broken off, and does not count."""
    return recording.end is not None and bool(recording.end["result"].get("broken_off"))


def environment_of(recording: Recording, observe: Sequence[str]) -> tuple[str, dict[str, Any]]:
    """The environment that plays a recording: its task, and its options as JSON values.

    Recordings with equal environments are of one data set.

    Args:
        recording: The recording.
        observe: Parts of observations, or `all` alone.

    Raises:
        RecordingError: Its task, encoder or robot is not on this machine.
    """
    settings = encoded(settings_of(recording))
    task = _from_anywhere(settings.pop("task"))
    del settings["seed"]
    # The recorded touches are what the screen made of the fingers.
    settings["variation"] |= dict.fromkeys(TOUCHES, 0.0)
    # An agent takes the place of whoever drove the devices.
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
    """The place of a task in a file as it is found from any folder; any other name as it is."""
    file = place_file(task)
    return task if file is None else f"{file}:{TASK_PLUGINS.member_at(task)}"


def changed_task(recording: Recording) -> str:
    """What has changed in a recording's own task since it was recorded, in a line; else empty.

    Raises:
        RecordingError: Its task, encoder or robot is not on this machine.
    """
    settings = settings_of(recording)
    return task_change(recording.header, settings.task, settings.seed, settings.surface.rectangle)


def demonstrate(recording: Recording, env: HandSandboxEnv) -> Demonstration:
    """Plays a recording's touches through an environment with its options.

    Touches take slots in the order of their beginning, and those of their fingers in the actions
    that are returned. States do not depend on slots, so these actions give the same states.

    Raises:
        RecordingError: The recording has no touches of every hand.
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
        # The recording ended first: a person gave up, or the input ended.
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
    """Observations (T + 1, 5, ...), or (T + 1, hands, 5, ...), with touches in other slots."""
    hands = len(touches)
    old = values if hands > 1 else values[:, None]
    # An empty slot shows what it did before the first step.
    new = np.repeat(old[:1], len(old), axis=0)
    for hand in range(hands):
        for touch, a, b in zip(touches[hand], before[hand], after[hand], strict=True):
            # The touch of a step is seen after it.
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
    """Notes the fingers that the touches of a control period were taken for."""
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
    """Checks that two recordings are of one environment.

    Args:
        first: What `environment_of` returned of the first one.
        other: The same of the other one.
        where: The other one's file, for errors.

    Raises:
        InputError: Tasks or options differ.
    """
    theirs = _flat(*other)
    for name, value in _flat(*first).items():
        if (got := theirs.get(name)) != value:
            raise InputError(
                "a data set is of one environment, and this recording is of another one",
                where=where,
                got=f"{name} {got}",
                expected=str(value),
                remedy="Export it by itself",
            )


def _flat(task: str, options: dict[str, Any]) -> dict[str, Any]:
    settings = {f"settings.{name}": value for name, value in options["settings"].items()}
    own = {"task": task, "labels": None, **options, **settings}
    return {**own, "settings": sorted(options["settings"])}
