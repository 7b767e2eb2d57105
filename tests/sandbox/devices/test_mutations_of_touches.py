"""Mutations of touch recordings and of captures of TUIO.

A detectable one ends equal, refused or reported: units times 10, 25.4 and 1000; rows doubled or
swapped; names in other bytes. An undetectable one, a row that is missing, changes that frame alone.
None ends in another exception than the reader's own.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import InputError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.device import Device, TouchDevice
from sandbox.devices.files.frame_file import frame_record, header_record
from sandbox.devices.files.touch_files import open_file
from sandbox.devices.own_device import GuardedDevice
from tests.support.tuio_packets import alv, blb, blobs, bnd, bundle, cur, frame, frame20, frm, ptr

SURFACE = Surface()
INCH = 0.0254
Row = dict[str, Any]
Mutation = Callable[[list[Row], int], None]
Shown = list[tuple[float, tuple[Contact, ...]]]

FRAMES: list[Row] = [
    header_record(SURFACE, "page"),
    *(
        frame_record(
            TouchFrame(
                n / 60,
                tuple(
                    Contact(i, (x + n / 40) * INCH, y * INCH, 0.009, extent=(0.008, 0.010))
                    for i, (x, y) in enumerate([(2.0, 3.0), (4.0, 2.5)])
                )
                if 2 < n < 58
                else (),
            )
        )
        for n in range(60)
    ),
]


def packets11(n: int, scale: float = 1.0, blob: float = 1.0) -> list[bytes]:
    """A frame of cursors and one of blobs."""
    ids = (1, 2) if 2 < n < 58 else ()
    places = {i: (0.3 * i + n / 300, 0.4) for i in ids}
    sets = [cur("set", i, scale * x, scale * y, 0.0, 0.0, 0.0) for i, (x, y) in places.items()]
    ellipses = [
        blb("set", i, x, y, 0.0, 0.04 * blob, 0.05 * blob, 0.002) for i, (x, y) in places.items()
    ]
    return [
        bundle(blb("alive", *ids), *ellipses, blb("fseq", n + 1)),
        bundle(cur("source", "table"), cur("alive", *ids), *sets, cur("fseq", n + 1)),
    ]


def packets20(n: int, scale: float = 1.0, blob: float = 1.0) -> list[bytes]:
    """A frame of pointers and bounds."""
    ids = (1, 2) if 2 < n < 58 else ()
    parts = [ptr(i, scale * (0.3 * i + n / 300), scale * 0.4) for i in ids]
    bounds = [bnd(i, 0.04 * blob, 0.05 * blob) for i in ids]
    return [bundle(frm(n + 1, "table"), *parts, *bounds, alv(*ids))]


def capture(made: Callable[..., list[bytes]], **scales: float) -> list[Row]:
    return [
        {"t": 7.0 + n / 60 + 1e-4 * k, "hex": data.hex(), "from": "192.0.2.5:4000"}
        for n in range(60)
        for k, data in enumerate(made(n, **scales))
    ]


def written(path: Path, rows: Sequence[Row | bytes]) -> Path:
    lines = [row if isinstance(row, bytes) else json.dumps(row).encode() for row in rows]
    path.write_bytes(b"".join(line + b"\n" for line in lines))
    return path


def played(path: Path) -> tuple[Shown, Device]:
    """What is shown when, each state once."""
    device = open_file(path, None).device
    frames = [(f.time, f.contacts) for f in device.poll(1e12)]
    return [next(same) for _, same in groupby(frames, key=lambda f: f[1])], device


def outcome(path: Path, sound: Shown) -> str:
    """equal, reported, refused, or differs."""
    try:
        shown, device = played(path)
    except InputError as error:
        assert len(str(error)) < 600
        return "refused"
    if device.damage is not None or (device.report is not None and device.report.line()):
        return "reported"
    return "equal" if shown == sound else "differs"


def of_contacts(names: str, factor: float) -> Mutation:
    """Multiplies values of contacts."""

    def mutate(rows: list[Row], at: int) -> None:
        for contact in (c for row in rows for c in row.get("contacts", ())):
            for name in names.split():
                contact[name] *= factor

    return mutate


def doubled(rows: list[Row], at: int) -> None:
    rows.insert(at, rows[at])


def swapped(rows: list[Row], at: int) -> None:
    rows[at], rows[at - 1] = rows[at - 1], rows[at]


FACTORS = (10.0, 25.4, 1000.0)
OF_FRAMES: list[Mutation] = [
    *(of_contacts("x y", factor) for factor in FACTORS),
    *(of_contacts("size width height", factor) for factor in (*FACTORS, 1 / 25.4, 1e-3)),
    *(of_contacts("x y size width height", factor) for factor in FACTORS),
    *(doubled, swapped),
]


@settings(max_examples=200)
@given(mutation=st.sampled_from(OF_FRAMES), at=st.integers(2, 60))
def test_a_detectable_mutation_of_recorded_touches_is_not_silent(
    tmp_path_factory: pytest.TempPathFactory, mutation: Mutation, at: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "touches.jsonl"
    sound, device = played(written(path, FRAMES))
    assert device.report is not None and not device.report.line() and len(sound) > 50
    rows = copy.deepcopy(FRAMES)
    mutation(rows, at)
    assert outcome(written(path, rows), sound) != "differs"


@pytest.mark.parametrize("made", [packets11, packets20])
@pytest.mark.parametrize("what", ["scale", "blob"])
@pytest.mark.parametrize("factor", [*FACTORS, 1 / 25.4, 1e-3])
def test_packets_in_other_units_are_not_silent(
    tmp_path: Path, made: Callable[..., list[bytes]], what: str, factor: float
) -> None:
    if what == "scale" and factor < 1.0:
        return  # All touches within a few millimetres may be meant.
    path = tmp_path / "packets.jsonl"
    sound, _ = played(written(path, capture(made)))
    assert outcome(written(path, capture(made, **{what: factor})), sound) != "differs"


@given(at=st.integers(2, 60))
def test_a_frame_that_is_missing_changes_that_frame_alone(
    tmp_path_factory: pytest.TempPathFactory, at: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "fewer.jsonl"
    sound = open_file(written(path, FRAMES), None).device.poll(1e9)
    fewer = open_file(written(path, [*FRAMES[:at], *FRAMES[at + 1 :]]), None).device.poll(1e9)
    assert list(fewer) == [*sound[: at - 1], *sound[at:]]


@given(made=st.sampled_from([packets11, packets20]), at=st.integers(6, 55))
def test_a_packet_that_is_missing_changes_that_frame_alone(
    tmp_path_factory: pytest.TempPathFactory, made: Callable[..., list[bytes]], at: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "fewer-packets.jsonl"
    rows = capture(made)
    per_frame = len(rows) // 60
    sound = dict(played(written(path, rows))[0])
    del rows[per_frame * at + per_frame - 1]
    fewer = dict(played(written(path, rows))[0])
    changed = {time for time in sound.keys() | fewer.keys() if sound.get(time) != fewer.get(time)}
    assert len(changed) == 1


NAMES = ["Tür".encode(), "Tür".encode("latin-1"), "机".encode("cp932"), b"\xff"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("rows", "old"),
    [(FRAMES, b"page"), (FRAMES, b"null"), (capture(packets11), b"192.0.2.5")],
    ids=["device", "finger", "sender"],
)
def test_names_in_any_bytes_cost_no_touch(
    tmp_path: Path, name: bytes, rows: list[Row], old: bytes
) -> None:
    path = tmp_path / "names.jsonl"
    sound, _ = played(written(path, rows))
    new = b'"' + name + b'"' if old == b"null" else name
    lines = [json.dumps(row).encode().replace(old, new) for row in rows]
    assert played(written(path, lines))[0] == sound


def renumbered(rows: list[Row]) -> list[Row]:
    """Touches that have a new id in every frame."""
    rows = copy.deepcopy(rows)
    for n, row in enumerate(rows):
        for contact in row.get("contacts", ()):
            contact["id"] += 10 * n
    return rows


def packets_renumbered(n: int) -> list[bytes]:
    ids = (10 * n, 10 * n + 1) if 2 < n < 58 else ()
    sets = [cur("set", i, 0.3 + 0.3 * (i % 10) + n / 300, 0.4, 0.0, 0.0, 0.0) for i in ids]
    return [bundle(cur("source", "table"), cur("alive", *ids), *sets, cur("fseq", n + 1))]


@pytest.mark.parametrize("rows", [renumbered(FRAMES), capture(packets_renumbered)])
def test_ids_that_change_in_every_frame_are_reported(tmp_path: Path, rows: list[Row]) -> None:
    _, device = played(written(tmp_path / "new_ids.jsonl", rows))
    assert device.report is not None
    assert "touches have new ids in most frames" in device.report.line()


def taps(apart: float) -> list[Row]:
    """A finger that is lifted and put down again and again, another one at rest."""
    rows = copy.deepcopy(FRAMES)
    for n, row in enumerate(rows):
        for contact in row.get("contacts", ())[:1]:
            contact["id"] = 100 + n // 2
            contact["x"] += apart * (n // 2)
        if n % 2:
            row["contacts"] = row["contacts"][1:]
    return rows


@pytest.mark.parametrize("apart", [0.0, 0.05])
def test_taps_have_new_ids_rightly(tmp_path: Path, apart: float) -> None:
    _, device = played(written(tmp_path / "taps.jsonl", taps(apart)))
    assert device.report is not None and not device.report.line()


class Pad(TouchDevice):
    """A device of one's own whose fingers are 2000 px high."""

    def poll(self, now: float) -> list[TouchFrame]:
        fingers = Contact(1, 0.1, 0.1, 0.008), Contact(2, 0.1, 0.05, 0.07, 3, (0.006, 0.4))
        return [TouchFrame(now, fingers)]


def test_a_device_of_one_s_own_has_no_impossible_sizes_either() -> None:
    device = GuardedDevice(Pad(Surface()), Surface(), "pad.py")
    ((first, second),) = (frame.contacts for frame in device.poll(0.5))
    assert first.size == 0.008
    assert (second.id, second.label, second.size, second.extent) == (2, 3, None, None)
    assert device.report.line() == "left out: 1 sizes that no finger or hand has"


def test_json_has_the_report_at_its_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "packets.jsonl"
    packets = [frame(1, {1: (0.5, 7.0), 2: (0.5, 0.5)}, source="x"), frame20(1, {2: (0.5, 0.5)})]
    packets += [blobs(2, {2: (0.5, 0.5, 40.0, 30.0)}), frame(2, {2: (0.5, 0.5)})]
    records = [{"t": n / 10, "hex": p.hex(), "from": "h:1"} for n, p in enumerate(packets)]
    path.write_text("".join(json.dumps(record) + "\n" for record in records))
    assert main(["touches", "show", "--device", str(path), "--json"]) == 0
    end = json.loads(capsys.readouterr().err.splitlines()[-1])
    assert end["left_out"] == {
        "positions beyond the surface": 1,
        "sizes that no finger or hand has": 1,
    }
    assert end["assumed"] == ["two sends every touch twice; each counts once"]
