"""`sandbox export LEAP.json`: the file holds PAALM's hands, where the Leap saw them."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from encoders.paalm import Paalm
from encoders.paalm.angles import joints_of_angles
from encoders.paalm.average import calibrate_on_recording
from encoders.paalm.hand_pose import PALM_CENTRE
from encoders.paalm.rig import bone_lengths
from models.frames import HandFrame
from models.motion.armature import Y_UP
from models.motion.bvh import read_bvh
from models.skeleton import ADULT
from sandbox.cli.main import main
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.leap.leap_write import leap_message
from tests.support.leap_hands import take

"""Frames of an open hand with which a take begins."""


LAST = ("index_dip", "middle_dip", "ring_dip", "little_dip")


RATE = 100


ZERO = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""File from hand in the zero pose (ZXY): its x lies along the file's z, its y along x."""


@cache
def frames(side: str) -> tuple[HandFrame, ...]:
    """A simulated hand: open at first, then moving."""
    return take(3 if side == "right" else 4, side=side).frames


def shifted(frame: HandFrame, x: float, number: int) -> HandFrame:
    """The frame, its hand moved to the right and its ids changed."""

    def moved(hand: Any) -> Any:
        fingers = tuple(
            replace(f, id=f.id + 1000 * number, tip=(f.tip[0] + x, *f.tip[1:]))
            for f in hand.fingers
        )
        palm = (hand.palm[0] + x, *hand.palm[1:])
        return replace(hand, id=hand.id + 1000 * number, palm=palm, fingers=fingers)

    return replace(frame, hands=tuple(moved(hand) for hand in frame.hands))


def write(path: Path, some: list[HandFrame]) -> Path:
    messages = [leap_message(frame, i) for i, frame in enumerate(some)]
    path.write_text(json.dumps({"metadata": {}, "frames": messages}))
    return path


@cache
def alone(side: str) -> list[HandFrame]:
    return [
        shifted(f, 0.15 if side == "right" else -0.15, int(side == "left")) for f in frames(side)
    ]


@cache
def together() -> list[HandFrame]:
    return [
        replace(a, hands=(*a.hands, *b.hands))
        for a, b in zip(alone("right"), alone("left"), strict=False)
    ]


def exported(source: Path, to: Path, *more: str) -> int:
    return main(["export", str(source), "--to", str(to), "--rate", str(RATE), *more])


def paalm_hands(path: Path, side: str) -> list[Any]:
    """What PAALM says of a file's frames, without the sandbox's reconstructor."""
    recording, paalm = read_leap(path), Paalm()
    assert calibrate_on_recording(paalm, recording.frames, cast(Any, side)) == ""
    return [paalm.step(frame).hands.get(side) for frame in recording.frames]


def tips_of(hand: Any) -> np.ndarray:
    """Tips (4, 3) m of index to little finger in the frame of a right hand, of PAALM's angles."""
    knuckles = np.array([ADULT.bones[i].anchor for i in ADULT.first_bone])
    return joints_of_angles(hand.table, knuckles, bone_lengths())[1:, 3]


def wrist_and_tips(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Wrist (n, 3), its frame (n, 3, 3) and fingertips (n, 4, 3) of a BVH, m in the device's
    frame."""
    motion = read_bvh(path)
    placed = motion.place()
    wrist = motion.index("wrist")
    tips = placed.ends[:, [motion.index(name) for name in LAST]]
    frame = Y_UP.T @ placed.rotations[:, wrist] @ ZERO
    return placed.positions[:, wrist] @ Y_UP, frame, tips @ Y_UP


@pytest.mark.parametrize("side", ["right", "left"])
def test_forward_kinematics_of_the_file_gives_paalms_fingertips(side: str, tmp_path: Path) -> None:
    path = write(tmp_path / "leap.json", alone(side))
    assert exported(path, tmp_path / "x.bvh", "--hand", side) == 0
    wrist, frame, tips = wrist_and_tips(tmp_path / "x.bvh")
    hands = paalm_hands(path, side)
    assert len(hands) == len(wrist)
    mirror = np.array([1.0 if side == "right" else -1.0, 1.0, 1.0])
    for i, hand in enumerate(hands):
        found = (tips[i] - wrist[i]) @ frame[i] * mirror
        assert np.abs(found - tips_of(hand)).max() < 1e-6, i


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_hand_that_rests_is_where_the_leap_saw_it(side: str, tmp_path: Path) -> None:
    still = [replace(alone(side)[0], time=0.01 * i) for i in range(150)]
    path = write(tmp_path / "leap.json", still)
    assert exported(path, tmp_path / "x.bvh", "--hand", side) == 0
    wrist, frame, tips = wrist_and_tips(tmp_path / "x.bvh")
    centre = np.array(PALM_CENTRE) * [1.0 if side == "right" else -1.0, 1.0, 1.0]
    (hand,) = still[0].hands
    palm = paalm_hands(path, side)[-1].palm
    assert np.abs(wrist[-1] + frame[-1] @ centre - palm.origin).max() < 1e-6
    assert np.abs(-frame[-1][:, 2] - hand.normal).max() < 1e-3
    # As far as an average hand reaches a person's fingertips; the device's palm says less.
    for tip in tips[-1]:
        assert min(np.linalg.norm(tip - f.tip) for f in hand.fingers) < 0.005
    # The file is y up and in cm, as the Leap is y up and in mm.
    motion = read_bvh(tmp_path / "x.bvh")
    at = motion.place()
    found = at.positions[-1, 0] + at.rotations[-1, 0] @ ZERO @ centre
    x, y, z = palm.origin
    assert np.abs(found - [x, z, -y]).max() < 1e-6


def test_both_hands_of_a_recording_are_the_hands_of_two_recordings(tmp_path: Path) -> None:
    path = write(tmp_path / "both.json", together())
    assert exported(path, tmp_path / "both.bvh") == 0
    for side in ("right", "left"):
        one = write(tmp_path / f"{side}.json", alone(side)[: len(together())])
        assert exported(one, tmp_path / f"one-{side}.bvh", "--hand", side) == 0
        text = (tmp_path / f"both-{side}.bvh").read_bytes()
        assert text == (tmp_path / f"one-{side}.bvh").read_bytes()


def test_keys_lie_at_the_recordings_own_times(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    some = alone("right")
    kept = [f for i, f in enumerate(some) if i < 200 or i == len(some) - 1 or rng.random() < 0.6]
    # The device's clock does not begin at zero.
    path = write(tmp_path / "gaps.json", [replace(f, time=f.time + 1234.5) for f in kept])
    assert exported(path, tmp_path / "x.bvh", "--hand", "right") == 0
    wrist, frame, tips = wrist_and_tips(tmp_path / "x.bvh")
    assert len(wrist) == len(some)
    truth = paalm_hands(path, "right")
    for then, hand in zip(kept, truth, strict=True):
        i = round(100 * (then.time - some[0].time))
        found = (tips[i] - wrist[i]) @ frame[i]
        assert np.abs(found - tips_of(hand)).max() < 1e-6


def test_a_hand_that_is_lost_keeps_its_pose_and_one_that_comes_late_waits_in_its_first(
    tmp_path: Path,
) -> None:
    some = alone("right")
    late = [replace(f, hands=()) if i < 50 or i >= 400 else f for i, f in enumerate(some)]
    path = write(tmp_path / "late.json", late)
    assert exported(path, tmp_path / "x.bvh", "--hand", "right") == 0
    wrist, _, tips = wrist_and_tips(tmp_path / "x.bvh")
    assert len(wrist) == len(some)
    for part in (wrist, tips):
        assert np.abs(part[:51] - part[50]).max() < 1e-6
        assert np.abs(part[400:] - part[-1]).max() < 1e-6
        assert np.abs(part[60] - part[350]).max() > 0.01


@pytest.mark.parametrize("share", [0.3, 0.7, 0.999])
def test_a_list_that_is_cut_short_is_refused_and_leaves_no_file(
    share: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "leap.json", alone("right"))
    text = path.read_text()
    path.write_text(text[: int(share * len(text))])
    assert exported(path, tmp_path / "x.bvh") == 2
    said = [t for t in capsys.readouterr().err.splitlines() if t.startswith("sandbox: ")]
    assert len(said) == 1 and "damaged or cut short" in said[0]
    assert [p.name for p in tmp_path.iterdir()] == ["leap.json"]


def test_what_cannot_be_exported_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    right = str(write(tmp_path / "right.json", alone("right")))
    named = [
        replace(f, hands=tuple(replace(h, side="right") for h in f.hands)) for f in alone("right")
    ]
    v3 = str(write(tmp_path / "v3.json", named))
    empty = str(write(tmp_path / "empty.json", [HandFrame(0.01 * i) for i in range(9)]))
    (tmp_path / "other.json").write_text('[{"a": 1}, {"b": 2}]')
    me = tmp_path / "me.json"
    assert (
        main(["paalm", "calibrate", right, "--hands", "right", "--out", str(me), "--frames", "100"])
        == 0
    )
    capsys.readouterr()
    for line, why in (
        ([empty], "this recording has no hand"),
        ([str(tmp_path / "other.json")], "no usable Leap frames"),
        ([v3, "--hand", "left"], "this hand is not in the recording"),
        ([right, "--hand", "both"], "never shows two hands"),
        ([right, "--hand", "left", "--calibration", str(me)], "this hand was not measured"),
        ([right, "--of", "commanded"], "Leave out --of"),
        ([right, "--calibration", str(tmp_path / "right.json")], "not a PAALM calibration"),
    ):
        assert main(["export", *line, "--to", str(tmp_path / "x.bvh")]) == 2, line
        said = [t for t in capsys.readouterr().err.splitlines() if t.startswith("sandbox: ")]
        assert len(said) == 1 and why in said[0], said
    assert not list(tmp_path.glob("x*"))
