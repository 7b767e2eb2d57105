"""`sandbox capture report` over a folder of a session under a camera, all of it simulated."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from encoders.captures.overhead.simulated_camera import simulate_overhead
from encoders.captures.paired.simulated_pair import FROZEN_PAIRED, PairedSession, simulate_paired
from sandbox.cli.capture.simulate import write_simulated, write_simulated_camera
from sandbox.cli.main import main
from sandbox.devices.files.paired_capture import ASKED, HANDS, TOUCHES, read_about

SHORT = replace(FROZEN_PAIRED, play=9.0, open_seconds=1.5)


@pytest.fixture(scope="module")
def session() -> PairedSession:
    return simulate_paired(4, 1, configuration=SHORT)


@pytest.fixture(scope="module")
def folder(session: PairedSession, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A session with marked corners, whose guide asked for the fingers that touched."""
    out = tmp_path_factory.mktemp("camera") / "day"
    write_simulated_camera(session, simulate_overhead(session, 3), out, "P1", corners=True)
    lines, before = [], list[int]()
    for frame, host in zip(session.touches, session.touch_arrived.tolist(), strict=True):
        fingers = sorted(session.labels.get(c.id, -1) for c in frame.contacts)
        if fingers and fingers != before and -1 not in fingers:
            lines.append(json.dumps({"host": host, "asked": fingers}) + "\n")
            before = fingers
    (out / ASKED).write_text("".join(lines))
    return out


def report(folder: Path, out: Path) -> dict[str, Any]:
    assert main(["capture", "report", str(folder), "--json", str(out)]) == 0
    document = json.loads(out.read_text())
    assert isinstance(document, dict)
    return document


def test_the_report_says_how_many_touches_have_a_name_and_how_many_were_asked_for(
    session: PairedSession, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = report(folder, tmp_path / "r.json")
    assert told["simulated"] is True and told["subject"] == "P1"
    assert told["touches"] >= len(session.labels)
    assert told["named"] >= 0.95 * told["touches"]
    assert told["asked"]["as_asked"] >= 0.95 * told["asked"]["contacts"] > 0
    assert "SIMULATED" in capsys.readouterr().out


def test_fingers_that_nobody_asked_for_are_counted_as_such(folder: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    for path in folder.iterdir():
        (other / path.name).write_bytes(path.read_bytes())
    lines = [json.loads(line) for line in (folder / ASKED).read_text().splitlines()]
    # As many fingers, and of two or less, none of those that touched.
    wrong = [
        line | {"asked": [f for f in range(5) if f not in line["asked"]][: len(line["asked"])]}
        for line in lines
        if len(line["asked"]) <= 2
    ]
    (other / ASKED).write_text("".join(json.dumps(line) + "\n" for line in wrong))
    asked = report(other, tmp_path / "r.json")["asked"]
    assert asked["contacts"] > 0 and asked["as_asked"] < 0.2 * asked["contacts"]


def test_a_folder_that_is_no_session_under_a_camera_is_told_in_one_line(
    session: PairedSession, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    leap, damaged = tmp_path / "leap", tmp_path / "damaged"
    write_simulated(session, leap, "P2")
    damaged.mkdir()
    for path in folder.iterdir():
        (damaged / path.name).write_bytes(path.read_bytes())
    (damaged / HANDS).write_text((damaged / HANDS).read_text().splitlines()[0] + "\n")
    for wrong in (leap, damaged, tmp_path / "nothing"):
        assert main(["capture", "report", str(wrong)]) == 2
        err = capsys.readouterr().err
        assert err.count("\n") == 1 and "Traceback" not in err, err


def test_a_session_that_is_recorded_again_keeps_what_was_known_of_the_camera(
    folder: Path, tmp_path: Path
) -> None:
    copy = tmp_path / "copy"
    files = ["--touches", str(folder / TOUCHES), "--hands", str(folder / HANDS)]
    line = ["capture", "record", *files, "--out", str(copy), "--seconds", "4"]
    assert main(line) == 0
    assert read_about(copy).corners == read_about(folder).corners is not None
    assert read_about(copy).fov == read_about(folder).fov is not None
    first = [(each / HANDS).read_text().split("\n")[0] for each in (folder, copy)]
    assert json.loads(first[0])["camera"] == json.loads(first[1])["camera"]
