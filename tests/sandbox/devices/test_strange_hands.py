"""Recordings of hands in the air as other programs write them: read as they are meant and reported,
or refused with the reason."""

from __future__ import annotations

import copy
import json
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.air.camera import Camera
from models.frames import HandFrame, LandmarkFrame, SeenHand
from models.motion.bvh import read_bvh
from models.plausible import FINGER, JUMPED
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.leap.leap import LeapDevice
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_file import LeapRecording, read_leap
from sandbox.devices.leap.leap_write import leap_message
from sandbox.devices.own_device import GuardedDevice
from sandbox.devices.webcam.landmarks import LandmarkRecording, header_record, message_of
from sandbox.devices.webcam.landmarks import read_landmarks as read_pictures
from tests.encoders.air.seen_hands import film, held_up
from tests.support.leap_hands import take
from tests.support.scripted import PlayedHands

Messages = list[dict[str, Any]]
COUNT = 60
CAMERA = Camera(60.0)


@cache
def _leap() -> str:
    frames = take(3, "v3").frames[100 : 100 + COUNT]
    return json.dumps([leap_message(frame, i + 1) for i, frame in enumerate(frames)])


@cache
def _pictures() -> str:
    frames = film([held_up(2.0 * i) for i in range(COUNT // 2)], CAMERA)
    return json.dumps([message_of(frame) for frame in frames])


def leap() -> Messages:
    """Messages of a right hand over a Leap, with joints."""
    messages: Messages = json.loads(_leap())
    return messages


def pictures() -> Messages:
    """Messages of a right hand before a camera."""
    messages: Messages = json.loads(_pictures())
    return messages


def as_lines(folder: Path, messages: Messages, name: str = "hands.jsonl") -> Path:
    path = folder / name
    header = [header_record(CAMERA)] if messages and "seen" in messages[0] else []
    path.write_text("\n".join(map(json.dumps, [*header, *messages])) + "\n")
    return path


def scaled(messages: Messages, length: float = 1.0, time: float = 1.0) -> Messages:
    """Messages whose lengths and times are multiplied."""
    for message in messages:
        for key in ("timestamp", "time", "taken"):
            if key in message:
                message[key] *= time
        for part in [*message.get("hands", []), *message.get("pointables", [])]:
            for key, value in part.items():
                if key.endswith("Position") or key in ("wrist", "bases"):
                    part[key] = (np.array(value) * length).tolist()
                elif key in ("length", "sphereRadius", "width"):
                    part[key] = value * length
        for hand in message.get("seen", []):
            hand["world"] = (np.array(hand["world"]) * length).tolist()
    return messages


def same(a: LeapRecording | LandmarkRecording, b: LeapRecording | LandmarkRecording) -> bool:
    """True if two recordings hold the same hands at the same times from their beginning."""
    return len(a.frames) == len(b.frames) and all(
        np.allclose(one, other, rtol=1e-6, atol=2e-6)
        for one, other in zip(numbers(a), numbers(b), strict=True)
    )


def numbers(recording: LeapRecording | LandmarkRecording) -> list[list[float]]:
    """Every number of each frame, first its time from the beginning; pixels in thousands."""
    out = []
    frames: tuple[HandFrame | LandmarkFrame, ...] = recording.frames
    for frame in frames:
        values: list[float] = [frame.time - frames[0].time]
        out.append(values)
        if isinstance(frame, LandmarkFrame):
            for picture in frame.hands:
                values += [*np.ravel(picture.world), *(1e-3 * np.ravel(picture.image))]
            continue
        for hand in frame.hands:
            values += [*hand.palm, *hand.direction]
            for finger in hand.fingers:
                values += [*finger.tip, finger.length, *np.ravel(finger.joints or ())]
    return out


def exported(path: Path, capsys: pytest.CaptureFixture[str], *more: str) -> str:
    """What an export says on stderr, in one line."""
    assert main(["export", str(path), "--to", str(path.with_suffix(".bvh")), *more]) == 0
    assert path.with_suffix(".bvh").exists()
    return " ".join(capsys.readouterr().err.split())


# Times and lengths in other units.


@pytest.mark.parametrize(
    ("messages", "length", "time", "said"),
    [
        *((leap, 1.0, 1e-3, "times are read in ms"), (leap, 1.0, 1e-6, "times are read in s")),
        *((leap, 1.0, 1e3, "times are read in ns"), (leap, 1e-3, 1.0, "lengths are read in m")),
        *((leap, 0.1, 1.0, "lengths are read in cm"), (leap, 1 / 25.4, 1.0, "read in in")),
        *((pictures, 1.0, 1e3, "times are read in ms"), (pictures, 1.0, 1e6, "read in us")),
        (pictures, 1.0, 1e9, "times are read in ns"),
    ],
)
def test_times_and_lengths_in_another_unit_are_read_in_it_and_reported(
    messages: Callable[[], Messages], length: float, time: float, said: str, tmp_path: Path
) -> None:
    read = read_leap if messages is leap else read_pictures
    recording = read(as_lines(tmp_path, scaled(messages(), length, time)))
    assert same(recording, read(as_lines(tmp_path, messages())))
    assert said in recording.report.line()


def shares(messages: Messages) -> Messages:
    for message in messages:
        for hand in message["seen"]:
            hand["image"] = (np.array(hand["image"]) / message["size"]).tolist()
    return messages


def test_landmarks_in_shares_of_the_picture_are_those_in_pixels(tmp_path: Path) -> None:
    read = read_pictures(as_lines(tmp_path, shares(pictures())))
    assert same(read, read_pictures(as_lines(tmp_path, pictures())))


def test_a_given_unit_is_used_and_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = as_lines(tmp_path, scaled(leap(), 1e-3, 1e-3))
    said = exported(path, capsys, "--unit", "m,ms")
    assert "times are read in ms, as --unit says" in said
    assert "lengths are read in m, as --unit says" in said


# Other shapes.


def nested(messages: Messages) -> Messages:
    for message in messages:
        for hand in message["hands"]:
            hand["fingers"] = [p for p in message["pointables"] if p["handId"] == hand["id"]]
        for finger in message.pop("pointables"):
            del finger["handId"]
    return messages


def with_bones(messages: Messages) -> Messages:
    for message in nested(messages):
        for finger in (f for hand in message["hands"] for f in hand["fingers"]):
            ends = [finger.pop(f"{j}Position") for j in ("mcp", "pip", "dip", "btip")]
            finger["bones"] = [{"type": i, "nextJoint": end} for i, end in enumerate(ends)]
            finger.pop("length")
    return messages


def with_named_axes(messages: Messages) -> Messages:
    for message in messages:
        for part in [*message["hands"], *message["pointables"]]:
            for key, value in part.items():
                if isinstance(value, list) and len(value) == 3:
                    part[key] = dict(zip("xyz", value, strict=True))
    return messages


def with_named_fingers(messages: Messages) -> Messages:
    names = ("THUMB", "INDEX", "MIDDLE", "RING", "PINKY")
    for message in messages:
        for finger in message["pointables"]:
            finger["type"] = f"TYPE_{names[finger['type']]}"
    return messages


def by_finger(messages: Messages) -> Messages:
    for message in nested(messages):
        for hand in message["hands"]:
            hand["fingers"] = dict(enumerate(hand["fingers"]))
    return messages


SHAPES: dict[str, Callable[[], Any]] = {
    "fingers in their hand": lambda: nested(leap()),
    "fingers by number": lambda: by_finger(leap()),
    "fingers by name": lambda: with_named_fingers(leap()),
    "bones": lambda: with_bones(leap()),
    "named axes": lambda: with_named_axes(leap()),
    "envelopes": lambda: [{"type": "frame", "frame": message} for message in leap()],
    "hands by side": lambda: [{**m, "hands": {"right": m["hands"][0]}} for m in leap()],
    "us since 1970": lambda: at(lambda t, i: 1_700_000_000_000_000 + t),
    "a list deep in a file": lambda: {"version": 2, "take": {"leap": {"frames": leap()}}},
}


@pytest.mark.parametrize("shape", SHAPES)
def test_another_shape_of_the_same_frames_is_read_as_they_are(shape: str, tmp_path: Path) -> None:
    whole = SHAPES[shape]()
    path = tmp_path / "shape.json"
    path.write_text("\n".join(map(json.dumps, whole if isinstance(whole, list) else [whole])))
    recording = read_leap(path)
    assert same(recording, read_leap(as_lines(tmp_path, leap()))) and not recording.report


# Sides.


def name_sides(message: dict[str, Any], *sides: str | None) -> None:
    """Names the sides of the hands of a message."""
    for key, hands in (("type", message.get("hands", [])), ("side", message.get("seen", []))):
        for hand, side in zip(hands, sides, strict=False):
            hand[key] = side


@pytest.mark.parametrize("messages", [leap, pictures])
def test_a_side_that_flips_for_moments_is_mended_and_makes_no_second_hand(
    messages: Callable[[], Messages], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    steady = as_lines(tmp_path, messages(), "steady.jsonl")
    some = messages()
    for message in some[20::10]:
        name_sides(message, "left")
    path = as_lines(tmp_path, some, "flipped.jsonl")
    assert not exported(steady, capsys)
    flips = len(some[20::10])
    assert f"mended: {flips} hands that were named for the other side" in exported(path, capsys)
    one, other = (read_bvh(p.with_suffix(".bvh")).place().positions for p in (steady, path))
    # The hand's bones are measured in fewer frames.
    assert np.abs(one - other).max() < 0.002


def doubled(messages: Messages) -> Messages:
    """Another right hand, 20 cm beside the first one, or in the other half of the picture."""
    for message in messages:
        for hand in copy.deepcopy(message.get("hands", [])):
            hand["id"] += 1
            hand["palmPosition"][0] += 200.0
            message["hands"].append(hand)
        for finger in copy.deepcopy(message.get("pointables", [])):
            finger["id"] += 10
            finger["handId"] += 1
            for key in [k for k in finger if k.endswith("Position")]:
                finger[key][0] += 200.0
            message["pointables"].append(finger)
        for seen in copy.deepcopy(message.get("seen", [])):
            seen["image"] = [[x + 200.0, y] for x, y in seen["image"]]
            seen["score"] -= 0.1
            message["seen"].append(seen)
    return messages


@pytest.mark.parametrize("messages", [leap, pictures])
@pytest.mark.parametrize("turned", [False, True], ids=["in order", "order changes"])
def test_of_two_right_hands_one_is_exported_all_the_time_and_the_other_reported(
    messages: Callable[[], Messages],
    turned: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    alone = as_lines(tmp_path, messages(), "alone.jsonl")
    both = doubled(messages())
    for message in both[10:20] if turned else ():
        message.get("hands", []).reverse()
        message.get("seen", []).reverse()
    path = as_lines(tmp_path, both, "both.jsonl")
    assert not exported(alone, capsys)
    said = exported(path, capsys)
    count = len(both)
    assert f"{count} of {count} pictures" in said or f"{count} frames of {count}" in said
    assert "two right hands" in said and f"{count} further hands of the same side" in said
    assert alone.with_suffix(".bvh").read_text() == path.with_suffix(".bvh").read_text()


@pytest.mark.parametrize("messages", [leap, pictures])
def test_two_hands_whose_names_are_swapped_for_moments_stay_two_hands(
    messages: Callable[[], Messages], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    both = doubled(messages())
    for message in both:
        name_sides(message, "right", "left")
    steady = as_lines(tmp_path, copy.deepcopy(both), "steady.jsonl")
    for message in both[20::10]:
        name_sides(message, "left", "right")
    path = as_lines(tmp_path, both, "swapped.jsonl")
    for file in (steady, path):
        to = file.with_suffix(".csv")
        assert main(["export", str(file), "--to", str(to)]) == 0
    assert f"mended: {2 * len(both[20::10])} hands" in " ".join(capsys.readouterr().err.split())
    one, other = (
        np.loadtxt(file.with_suffix(".csv"), delimiter=",", skiprows=1) for file in (steady, path)
    )
    assert np.abs(one - other).max() < 0.002


# More of every kind: either equal and without a word, or with this one.


def every(change: Callable[[dict[str, Any], int], object], messages: Messages) -> Messages:
    for i, message in enumerate(messages):
        change(message, i)
    return messages


def at(change: Callable[[int, int], object]) -> Messages:
    """Messages of a Leap with other times."""
    return every(lambda m, i: m.update(timestamp=change(m["timestamp"], i)), leap())


def leaps(change: Callable[[dict[str, Any], int], object]) -> Callable[[], Messages]:
    """Makes changed messages of a Leap."""
    return lambda: every(change, leap())


def hands(**values: object) -> Callable[[], Messages]:
    """Makes messages of a Leap whose hand has other values."""
    return lambda: every(lambda m, i: m["hands"][0].update(values), leap())


def seen(change: Callable[[dict[str, Any]], dict[str, Any]]) -> Callable[[], Messages]:
    """Makes messages of a camera whose hand has other values."""
    return lambda: every(lambda m, i: m["seen"][0].update(change(m["seen"][0])), pictures())


SIBLINGS: dict[str, tuple[Callable[[], Messages], str]] = {
    "seconds since 1970": (lambda: at(lambda t, i: 1.7e9 + t * 1e-6), "times are read in s:"),
    "numbers for times": (lambda: at(lambda t, i: i), "refused: impossible in any unit"),
    "texts for times": (lambda: at(lambda t, i: str(t)), "refused: 60 frames refused: timestamp"),
    "times that are all zero": (lambda: at(lambda t, i: 0), "refused: two frames is zero"),
    "no times": (
        leaps(lambda m, i: m.pop("timestamp")),
        "no times: 100 a second are assumed",
    ),
    "a time in every third frame": (
        lambda: at(lambda t, i: None if i % 3 else t),
        "left out: 40 frames refused: no time, unlike other frames",
    ),
    "frames that are missing by their numbers": (
        lambda: [*leap()[:20], *leap()[25:]],
        "left out: 5 frames missing by their numbers",
    ),
    "frames without hands": (
        leaps(lambda m, i: m.pop("hands") if i % 2 else None),
        "left out: 150 fingers without a hand",
    ),
    "fingers without lengths": (
        leaps(
            lambda m, i: m.update(
                pointables=[
                    {key: p[key] for key in ("id", "handId", "direction", "tipPosition")}
                    for p in m["pointables"]
                ]
            )
        ),
        "refused: no finger in any frame",
    ),
    "hands without fingers": (
        leaps(lambda m, i: m.update(pointables=[])),
        "refused: no finger in any frame",
    ),
    "landmarks in shares of the picture for places in space": (
        seen(lambda hand: {"world": [[x / 640, y / 480, 0.0] for x, y in hand["image"]]}),
        "refused: wrist to knuckles is impossible in any unit",
    ),
    "places from -1 to 1": (
        seen(lambda hand: {"image": [[x / 320 - 1, y / 240 - 1] for x, y in hand["image"]]}),
        "refused: impossible in any unit",
    ),
    "a side that is wrong in the first frame": (
        leaps(lambda m, i: i or m["hands"][0].update(type="left")),
        "the left hand is not exported: 1 frame of 60 name it",
    ),
    "sides as MediaPipe names them": (seen(lambda hand: {"side": "Right"}), ""),
    "two hands without sides": (lambda: named(None, None), "does not say whose hands they are"),
    "two right hands with one id": (
        lambda: every(lambda m, i: [hand.update(id=1) for hand in m["hands"]], doubled(leap())),
        "refused: no usable Leap frames",
    ),
    "a fingertip nine metres away": (
        leaps(lambda m, i: i == 30 and m["pointables"][1].update(tipPosition=[9e3, 0.0, 0.0])),
        "left out: 1 fingers skipped: the tip is beyond a hand's reach",
    ),
    "a hand that jumps by a metre for a frame": (
        leaps(lambda m, i: moved(m, 1000.0) if i == 30 else None),
        "1 hands skipped: hands that jump farther than a hand moves",
    ),
    "a hand that leaves, and comes in again a metre farther": (
        leaps(
            lambda m, i: (
                (m.update(hands=[], pointables=[]) if i < 35 else moved(m, 1000.0))
                if i >= 25
                else None
            )
        ),
        "",
    ),
    # A head over the device that is taken for a hand for a moment: leapjs 69.
    "a second hand without fingers for a moment": (
        leaps(lambda m, i: second(m) if 20 <= i < 26 else None),
        "too few frames show five fingers of the left hand",
    ),
    # Ids that change while two hands are seen: LeapMotionAS3 10.
    "ids that are new in every frame": (
        lambda: every(lambda m, i: renumbered(m, 100 + 2 * i), named("right", "left")),
        "",
    ),
    # Palms that are always at the origin: Reach 8.
    "palms that are zero": (
        hands(palmPosition=[0.0] * 3),
        "refused: the distance from palm to fingertips is impossible in any unit",
    ),
    # One number for a place: leap-cursor-library 11.
    "a number for a palm": (
        hands(palmPosition=153.0),
        "refused: palmPosition is not three finite numbers",
    ),
    # Fingers alone: matleap 12.
    "fingers without hands": (
        leaps(lambda m, i: m.update(hands=[])),
        "refused: this recording has no hand",
    ),
    # Axes that are exchanged, as ROS has z up: ros-drivers/leap_motion 54.
    "two axes that are exchanged": (
        lambda: every(lambda m, i: exchanged(m), bent()),
        "by the way its fingers bend, the right hand is a left hand",
    ),
    # A hand that becomes the other one while it beckons: MixedRealityToolkit-Unity 10615.
    "a hand of the other side by its name all the time": (
        lambda: every(lambda m, i: m["hands"][0].update(type="left"), bent()),
        "by the way its fingers bend, the left hand is a right hand",
    ),
    # A hand that stays after it was lost: com.xrtk.oculus 141, STYLY-NetSync 474.
    "a hand that stands still in all digits for two seconds": (
        lambda: frozen(leap(), 200),
        "a hand did not move in any digit for",
    ),
    # The same hand twice: mediapipe 3902; of both sides: jweb-hands-landmarker 1.
    "a hand that is there as the other one, too": (
        lambda: every(lambda m, i: again(m, "left"), pictures()),
        "left out: 30 hands that lie on another one",
    ),
    # Points in space that are no numbers: mediapipe 5822.
    "points in space that are null": (
        lambda: every(
            lambda m, i: m["seen"][0].update(world=None) if i % 5 == 2 else None, pictures()
        ),
        "left out: 6 pictures: hands that cannot be read",
    ),
    # A name that is always the other one: mediapipe 4803, mediapipe-touchdesigner 86.
    "a right hand that is always named left": (
        seen(lambda hand: {"side": "Left"}),
        "by the way its fingers bend, the left hand is a right hand",
    ),
    "shares of the picture": (
        lambda: shares(pictures()),
        "image coordinates are read in 0..1",
    ),
    "pictures without their size": (
        lambda: every(lambda m, i: m.pop("size"), pictures()),
        "pictures do not state their size; 640 x 480 pixels are assumed",
    ),
    # Width and height exchanged: mediapipe-touchdesigner 85, three.js 26080.
    "shares of a picture whose width and height are exchanged": (
        lambda: every(lambda m, i: m.update(size=m["size"][::-1]), shares(pictures())),
        "hands are 0.58 times as wide in the picture as in space",
    ),
    # y up, as engines of games have it: MediaPipeUnityPlugin 1373.
    "points in space with y up": (
        seen(lambda hand: {"world": [[x, -y, z] for x, y, z in hand["world"]]}),
        "mirrored compared with points in space",
    ),
    "points in space about the wrist": (
        seen(lambda hand: {"world": (np.array(hand["world"]) - hand["world"][0]).tolist()}),
        "",
    ),
    "a picture that is a mirror's": (
        seen(lambda hand: {"image": [[640 - x, y] for x, y in hand["image"]]}),
        "mirrored compared with points in space",
    ),
}


def moved(message: dict[str, Any], millimetres: float) -> None:
    """Moves all of a Leap's message to the right."""
    for part in [*message["hands"], *message["pointables"]]:
        for key in [k for k in part if k.endswith("Position") or k == "wrist"]:
            part[key][0] += millimetres


def bent() -> Messages:
    """Messages of a right hand over a Leap that grasps."""
    messages = leap()
    for message in messages:
        for finger in message["pointables"][1:]:
            mcp, pip = np.array(finger["mcpPosition"]), np.array(finger["pipPosition"])
            down = np.array(message["hands"][0]["palmNormal"])
            bone = float(np.linalg.norm(pip - mcp))
            finger["dipPosition"] = (pip + 0.6 * bone * down).tolist()
            for key in ("tipPosition", "btipPosition"):
                finger[key] = (pip + bone * down).tolist()
    return messages


def exchanged(message: dict[str, Any]) -> None:
    """Exchanges y and z of all vectors of a Leap."""
    for part in [*message["hands"], *message["pointables"]]:
        for key, value in part.items():
            if isinstance(value, list) and len(value) == 3 and not isinstance(value[0], list):
                part[key] = [value[0], value[2], value[1]]


def second(message: dict[str, Any]) -> None:
    """Adds a left hand without fingers, 20 cm beside the first one."""
    hand, *_ = doubled([copy.deepcopy(message)])[0]["hands"][1:]
    hand.update(id=50, type="left")
    message["hands"].append(hand)


def renumbered(message: dict[str, Any], first: int) -> None:
    """Gives new ids to hands."""
    new = {hand["id"]: first + n for n, hand in enumerate(message["hands"])}
    for part in message["hands"]:
        part["id"] = new[part["id"]]
    for part in message["pointables"]:
        part["id"] += 10 * (new[part["handId"]] - part["handId"])
        part["handId"] = new[part["handId"]]


def frozen(messages: Messages, count: int) -> Messages:
    """Repeats the last message at new times."""
    last = messages[-1]
    more = [
        {**last, "id": last["id"] + n, "timestamp": last["timestamp"] + 10_000 * n}
        for n in range(1, count + 1)
    ]
    return [*messages, *more]


def again(message: dict[str, Any], side: str) -> None:
    """Adds the same hand, a few pixels beside, and a little less certain."""
    hand = copy.deepcopy(message["seen"][0])
    hand.update(side=side, score=0.6, image=[[x + 4, y - 3] for x, y in hand["image"]])
    message["seen"].append(hand)


def named(*sides: str | None) -> Messages:
    """Two hands with these sides; None leaves a side out."""
    return every(lambda m, i: name_sides(m, *sides), doubled(leap()))


@pytest.mark.parametrize("name", SIBLINGS)
def test_a_sibling_is_read_as_it_is_meant_or_refused_with_the_reason(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make, word = SIBLINGS[name]
    path = as_lines(tmp_path, make(), "sibling.jsonl")
    refused = word.startswith("refused: ")
    assert main(["export", str(path), "--to", str(tmp_path / "x.bvh")]) == 2 * refused
    said = " ".join(capsys.readouterr().err.split())
    assert word.removeprefix("refused: ") in said and bool(said) == bool(word)


# Live devices.


def test_a_live_leap_with_another_unit_goes_on_in_it_with_a_notice() -> None:
    server = FakeLeapd(scaled(leap(), 0.1, 1e-3), port=0, rate=500.0, loop=True)
    device = LeapDevice(server.address)
    try:
        frames: list[HandFrame] = []
        end = time.monotonic() + 20.0
        while not device.notices and time.monotonic() < end:
            frames += device.poll(0.0)
        while len(frames) < COUNT and time.monotonic() < end:
            frames += device.poll(0.0)
        assert "lengths are read in cm" in device.notices[0]
        assert "times are read in ms" in str(device.report and device.report.line())
        finger = max(f.length for f in frames[-1].hands[0].fingers)
        assert FINGER.includes(finger)
        assert frames[-1].time > frames[0].time
    finally:
        device.close()
        server.close()


@pytest.mark.parametrize("messages", [leap, pictures])
def test_a_hand_of_somebody_s_own_device_that_jumps_is_left_out(
    messages: Callable[[], Messages], tmp_path: Path
) -> None:
    read = read_leap if messages is leap else read_pictures
    frames: list[Any] = list(read(as_lines(tmp_path, messages())).frames)
    for i in (5, 20):
        hand = frames[i].hands[0]
        if isinstance(hand, SeenHand):
            image = tuple((320.0 + 0.1 * x, 240.0 + 0.1 * y) for x, y in hand.image)
            other: Any = replace(hand, image=image)
        else:
            other = replace(hand, palm=(hand.palm[0] + 1.0, *hand.palm[1:]))
        frames[i] = replace(frames[i], hands=(other,))
    device = GuardedDevice(PlayedHands(frames), Surface(), "own.py", type(frames[0]))
    shown = device.poll(1e9)
    assert [i for i, frame in enumerate(shown) if not frame.hands] == [5, 20]
    assert device.report.line() == f"left out: 2 {JUMPED}"
