"""Captures of packets: read up to the damage, and played as the device they came from."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import RecordingError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.tuio.touch_capture import (
    CaptureDevice,
    CapturedPacket,
    TouchCapture,
    read_capture,
)
from tests.support.tuio_packets import frame

GOOD = [json.dumps({"t": 3.0 + n / 8, "hex": frame(n, {}).hex()}) for n in range(4)]


def written(path: Path, *lines: str | bytes) -> Path:
    path.write_bytes(
        b"".join((line.encode() if isinstance(line, str) else line) + b"\n" for line in lines)
    )
    return path


DAMAGE: dict[str, str | bytes] = {
    "cut": GOOD[2][:30],
    "another object": '{"a": 4}',
    "zeros": b"\x00" * 50,
    "nested too deep": "[" * 100_000,
    "endless line": "x" * 1_000_000,
}

ODD: dict[str, str | bytes] = {
    "odd hex": '{"t": 4, "hex": "abc"}',
    "hex is a number": '{"t": 4, "hex": 12}',
    "no time": '{"hex": "00"}',
    "time is a text": '{"t": "4", "hex": "00"}',
    "time is infinite": '{"t": 1e999, "hex": "00"}',
    "time is huge": '{"t": 1' + "0" * 400 + ', "hex": "00"}',
    "time runs backwards": '{"t": 3.1, "hex": "00"}',
    "time runs ahead": '{"t": 3e9, "hex": "00"}',
    "not UTF-8": b'{"t": 4, "hex": "\xff"}',
    "larger than UDP": '{"t": 4, "hex": "' + "00" * 65_508 + '"}',
}


@pytest.mark.parametrize("line", ODD.values(), ids=ODD.keys())
def test_an_odd_packet_costs_itself_alone(tmp_path: Path, line: str | bytes) -> None:
    capture = read_capture(written(tmp_path / "touches.jsonl", *GOOD[:2], line, *GOOD[2:]))
    assert capture.damage is None
    assert [packet.time for packet in capture.packets] == [3.0 + n / 8 for n in range(4)]
    assert capture.report.left_out.total() == 1
    assert "packets" in capture.report.line() or "frames" in capture.report.line()


def moving(unit: float) -> list[str]:
    """The packets of a finger that moves, with times in another unit."""
    packets = [frame(n + 1, {1: (n / 40, 0.5)}) for n in range(30)]
    return [json.dumps({"t": n / 60 * unit, "hex": p.hex()}) for n, p in enumerate(packets)]


@pytest.mark.parametrize(("unit", "name"), [(1.0, ""), (1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_times_are_read_in_the_unit_in_which_they_are_possible(
    tmp_path: Path, unit: float, name: str
) -> None:
    capture = read_capture(written(tmp_path / "touches.jsonl", *moving(unit)))
    assert [p.time for p in capture.packets] == pytest.approx([n / 60 for n in range(30)])
    assert capture.report.line().startswith(f"times are read in {name}" if name else "")
    assert bool(name) == bool(capture.report.line())
    given = read_capture(tmp_path / "touches.jsonl", "s")
    assert given.packets[1].time == pytest.approx(unit / 60)
    device = CaptureDevice(capture, Surface())
    assert all(len(f.contacts) == 1 for f in device.poll(1e9)[:30])
    assert device.report.line() == capture.report.line()


@pytest.mark.parametrize("unit", [0.0, 1e-3])
def test_times_that_are_impossible_in_any_unit_are_refused(tmp_path: Path, unit: float) -> None:
    with pytest.raises(RecordingError, match=r"zero|impossible"):
        read_capture(written(tmp_path / "touches.jsonl", *moving(unit)))


@pytest.mark.parametrize("line", DAMAGE.values(), ids=DAMAGE.keys())
def test_a_damaged_file_is_good_up_to_the_line_that_is_named(
    tmp_path: Path, line: str | bytes
) -> None:
    capture = read_capture(written(tmp_path / "touches.jsonl", GOOD[0], "", GOOD[1], line, GOOD[3]))
    assert len(capture.packets) == 2
    assert isinstance(capture.damage, RecordingError)
    assert "touches.jsonl, line 4" in str(capture.damage)
    assert len(str(capture.damage)) < 600


@pytest.mark.parametrize("lines", [(), ("",), ("hello", *GOOD)], ids=["empty", "blank", "text"])
def test_a_file_without_a_single_packet_is_refused(tmp_path: Path, lines: tuple[str, ...]) -> None:
    with pytest.raises(RecordingError, match="touches"):
        read_capture(written(tmp_path / "touches", *lines))


def played(capture: TouchCapture, moments: list[float]) -> list[TouchFrame]:
    device = CaptureDevice(capture, Surface(), stale_after=0.5)
    frames: list[TouchFrame] = []
    for now in moments:
        due = device.poll(now)
        assert all(f.time <= now for f in due)
        frames += due
    assert device.finished
    return frames


GAPS = st.lists(st.floats(0.0, 2.0), min_size=1, max_size=12)


@given(GAPS, st.lists(st.floats(0.0, 30.0), max_size=30))
def test_what_is_played_does_not_depend_on_when_it_is_asked_for(
    gaps: list[float], moments: list[float]
) -> None:
    times = [sum(gaps[: n + 1]) for n in range(len(gaps))]
    capture = TouchCapture(
        tuple(CapturedPacket(t, frame(n + 1, {1: (0.5, 0.5)})) for n, t in enumerate(times))
    )
    all_at_once = played(capture, [1000.0])
    assert played(capture, [*sorted(moments), 1000.0]) == all_at_once
    assert all_at_once[0].time == 0.0
    assert [f.time for f in all_at_once] == sorted(f.time for f in all_at_once)
    silences = sum(gap > 0.5 + 1e-9 for gap in gaps[1:])
    nearly = sum(abs(gap - 0.5) <= 1e-9 for gap in gaps[1:])
    assert silences <= sum(not f.contacts for f in all_at_once) <= silences + nearly
