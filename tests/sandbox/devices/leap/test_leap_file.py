"""Leap recordings are recognised by content, and damaged ones say so in one clear error."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import RecordingError
from sandbox.devices.device import Sees
from sandbox.devices.files.paired_capture import read_hands
from sandbox.devices.leap.leap import LeapFileDevice
from sandbox.devices.leap.leap_file import decompress_base64, read_leap
from sandbox.devices.leap.leap_write import leap_message, take_with_truth, write_take
from sandbox.devices.registry import kind_of
from tests.support.leap_hands import take


@cache
def messages() -> list[dict[str, Any]]:
    return [leap_message(f, n) for n, f in enumerate(take(0, "v3").frames[:20])]


# Made with the npm format's reference implementation in Python (PyPI lzstring 1.0.4).
VECTORS = {
    "Q===": "",
    "IZA=": "a",
    "BYUwNmD2AEoTcpA=": "hello hello hello",
    "IY18ZXTt/DFOS1b0c17Pd/wYUcSaWeRZVdTbXTEA": "a" * 1000,
    "N4IghiBcAEDaCMAaaAmZBmAuskAjK0IAP4DUEIAvqBDAsmtFjvjMWZeAbahtoc4aQpA=": '{"a": [1, 2, 3], '
    '"b": "ü€"}' * 3,
}


def packed(messages: list[dict[str, Any]]) -> list[Any]:
    """The messages as LeapJS packs them: keys once, then rows."""
    hand, finger = list(messages[0]["hands"][0]), list(messages[0]["pointables"][0])
    rows = [
        [
            m["id"],
            m["timestamp"],
            [[h[k] for k in hand] for h in m["hands"]],
            [[p[k] for k in finger] for p in m["pointables"]],
        ]
        for m in messages
    ]
    return [["id", "timestamp", {"hands": [hand]}, {"pointables": [finger]}], *rows]


FORMS: dict[str, Callable[[], str]] = {
    "list": lambda: json.dumps(messages()),
    "with metadata": lambda: json.dumps({"metadata": {"frameRate": "100"}, "frames": messages()}),
    "packed": lambda: json.dumps({"metadata": {}, "frames": packed(messages())}),
    "lines": lambda: "".join(json.dumps(m) + "\n" for m in [{"version": 6}, *messages()]),
    "count and list": lambda: json.dumps({"frames": len(messages()), "data": messages()}),
    "printed prettily": lambda: json.dumps({"frames": messages()}, indent=1),
}


@cache
def small(form: str) -> bytes:
    return FORMS[form]().encode()


@pytest.mark.parametrize("text", VECTORS)
def test_lz_string_decodes_what_its_reference_implementation_encoded(text: str) -> None:
    assert decompress_base64(text) == VECTORS[text]


@given(st.text(alphabet="ABCDEFabcdef0123+/=", max_size=80))
def test_no_text_makes_the_lz_decoder_do_anything_but_decode_or_refuse(text: str) -> None:
    with contextlib.suppress(RecordingError):
        assert isinstance(decompress_base64(text, limit=10_000), str)


def test_a_small_text_cannot_ask_for_more_memory_than_allowed() -> None:
    with pytest.raises(RecordingError, match="too large"):
        decompress_base64("IY18ZXTt/DFOS1b0c17Pd/wYUcSaWeRZVdTbXTEA", limit=999)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("mark", ["", "\ufeff"], ids=["", "byte order mark"])
def test_every_form_of_a_file_holds_the_same_frames(form: str, mark: str, tmp_path: Path) -> None:
    path = tmp_path / "no-telling-name"
    path.write_text(mark + FORMS[form](), encoding="utf-8")
    assert kind_of(str(path)).sees is Sees.LEAP
    recording = read_leap(path)
    assert len(recording.frames) == len(messages())
    tips = [[f.tip for f in frame.hands[0].fingers] for frame in recording.frames]
    known = [[f.tip for f in frame.hands[0].fingers] for frame in take(0, "v3").frames[:20]]
    np.testing.assert_allclose(tips, known, atol=1e-9)
    assert recording.damage is None


def test_frames_without_times_have_the_rate_of_the_file_also_beside_touches(tmp_path: Path) -> None:
    path = tmp_path / "slow.json"
    bare = [{k: v for k, v in m.items() if k != "timestamp"} for m in messages()]
    path.write_text(json.dumps({"metadata": {"frameRate": "50"}, "frames": bare}))
    known = 0.02 * np.arange(len(bare))
    np.testing.assert_allclose([f.time for f in read_leap(path).frames], known, atol=1e-9)
    np.testing.assert_allclose(read_hands(path).time, known, atol=1e-9)


def test_lines_are_good_up_to_the_damage(tmp_path: Path) -> None:
    path = tmp_path / "torn"
    path.write_text(FORMS["lines"]()[:-200])
    recording = read_leap(path)
    assert len(recording.frames) == len(messages()) - 1
    assert recording.damage is not None and "line 21" in str(recording.damage)


@pytest.mark.parametrize(
    "content",
    (
        *(b"", b"  \n", b"a letter to somebody", b'{"frames": "many"}', b'{"u": 1}', b"[1, 2, 3]"),
        b'{"frames": [{"id": 1, "timestamp": NaN, "hands": [], "pointables": []}]}',
        *(b"\x89PNG\r\n\x1a\n\x00\x00", b"HIERARCHY\nROOT Hips\n", b'{"frames": [[1], [2, 3]]}'),
        b'{"frames": [["id", {"hands": [["id"]]}], [1], 5]}',
        b"[" * 100_000,
        b'{"ha\xf2ds": []}',
        FORMS["list"]()[:-300].encode(),
        FORMS["with metadata"]()[:3000].encode(),
        b"N4IgZgTghgtgpgZxALgNqgMYFcITgOwBcAxaeAJSkLhQEZaAGAOgBYAmAdgBoQBzRQjkQpUA",
    ),
)
def test_a_file_that_is_no_recording_is_refused_with_its_name(
    content: bytes, tmp_path: Path
) -> None:
    path = tmp_path / "foreign.json"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=r"foreign\.json"):
        read_leap(path)


def test_compressed_recordings_are_recognised_and_files_of_other_programs_are_not(
    shared_data: Path, tmp_path: Path
) -> None:
    for path in (shared_data / "leap").iterdir():
        bare = tmp_path / path.name.partition(".")[0]
        bare.write_bytes(path.read_bytes())
        assert kind_of(str(bare)).sees is Sees.LEAP, path.name
    for content in (b"", b"HIERARCHY\nROOT Hips\n", b'{"u": 1}', b"[1, 2]", b"\x89PNG"):
        other = tmp_path / "other"
        other.write_bytes(content)
        assert kind_of(str(other)).sees is not Sees.LEAP
    run = tmp_path / "run.jsonl"
    header = {"kind": "header", "schema": 2, "version": "1", "settings": {"hands": []}}
    hands = {"kind": "input", "time": 0.0, "hands": []}
    run.write_text(json.dumps(header) + "\n" + json.dumps(hands) + "\n")
    assert kind_of(str(run)).sees is not Sees.LEAP


def test_two_lists_of_frames_in_one_file_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "two.json"
    path.write_text(json.dumps({"a": messages()[:2], "b": messages()[:2]}))
    with pytest.raises(RecordingError, match=r"two\.json: two lists"):
        read_leap(path)


@settings(max_examples=80)
@given(
    form=st.sampled_from(sorted(FORMS)),
    damage=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), min_size=1, max_size=6),
    cut=st.floats(0.05, 1.0),
)
def test_bytes_that_changed_are_refused_or_counted_and_raise_nothing_else(
    form: str, damage: list[tuple[float, int]], cut: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    content = bytearray(small(form))
    for place, byte in damage:
        content[int(place * (len(content) - 1))] = byte
    path = tmp_path_factory.mktemp("damaged") / "hand"
    path.write_bytes(content[: int(cut * len(content))])
    with contextlib.suppress(RecordingError):
        assert read_leap(path).frames


def test_a_recording_plays_every_frame_when_it_is_due(tmp_path: Path) -> None:
    path = tmp_path / "hand"
    path.write_text(FORMS["list"]())
    recording = read_leap(path)
    device = LeapFileDevice(recording)
    played = []
    for step in range(60):
        now = 0.004 * step
        for frame in device.poll(now):
            assert frame.time - recording.frames[0].time <= now
            played.append(frame)
    assert tuple(played) == recording.frames and device.finished


def test_a_simulated_recording_brings_its_truth_along(tmp_path: Path) -> None:
    known, path = take(2), tmp_path / "hand.json"
    write_take(known, path, {"seed": 2})
    found = take_with_truth(read_leap(path), str(path))
    assert found is not None
    np.testing.assert_allclose(found.angles, known.angles, atol=1e-4)
    assert found.fingers == known.fingers and (found.open == known.open).all()
    spoiled = json.loads(path.read_text())
    del spoiled["frames"][5]["truth"]["angles"]
    path.write_text(json.dumps(spoiled))
    with pytest.raises(RecordingError, match="truth of this recording is damaged"):
        take_with_truth(read_leap(path), str(path))


def test_recordings_made_by_other_programs_are_read_whole(shared_data: Path) -> None:
    expected = {
        "v1-hands.json": ("v1", 744),
        "HandSplay-110fps.json.lz": ("v2", 288),
        "grab.json.lz": ("v2", 374),
        "pinch-57fps.json.lz": ("v2", 133),
        "waiting-short.json.lz": ("v2", 118),
    }
    for name, (dialect, frames) in expected.items():
        recording = read_leap(shared_data / "leap" / name)
        assert (recording.dialect, len(recording.frames)) == (dialect, frames)
        assert not [why for why in recording.counts if "skipped" in why or "refused" in why]
        found = [f for frame in recording.frames for hand in frame.hands for f in hand.fingers]
        for finger in (f for f in found if f.joints is not None):
            # Only the last of them has ends of bones that are not the tips.
            bone = math.dist(finger.joints[2], finger.joints[3])
            beyond = 0.23 if name == "pinch-57fps.json.lz" else 0.0
            assert math.dist(finger.end, finger.tip) / bone == pytest.approx(beyond, abs=0.01)
