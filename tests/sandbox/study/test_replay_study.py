"""A trial of a study is found by its name, compared state by state, and looked at from anywhere."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import RecordingError
from sandbox.cli.main import main
from sandbox.recording.recording import load_recording, packed, read_stored
from sandbox.session.messages import Snapshot
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.trial_files import find_recordings
from sandbox.study.run.simulated_study import run_simulated
from sandbox.trial.replay import Playback
from tests.support.study_files import TRIALS, first_session, open_study, quiet

PERIOD = 0.016


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    found = open_study(tmp_path_factory.mktemp("replays"))
    run_simulated(found, 1, quiet)
    return found


@pytest.fixture
def session(study: StudyFolder) -> Path:
    return first_session(study)


def test_a_trial_is_found_by_its_name_with_and_without_its_session(
    study: StudyFolder, session: Path
) -> None:
    out, ppid = study.path.parent, session.parent.name
    name = f"{study.path.name}/{ppid}"
    told = [session / "trials/T003.jsonl"]
    assert find_recordings(f"{name}/S001/T003", out) == told
    assert find_recordings(f"{name}/T003", out) == told
    assert find_recordings(str(session / "T003"), Path("elsewhere")) == told
    assert find_recordings(str(session / "trials/T003"), Path("elsewhere")) == told
    assert find_recordings(str(told[0]), Path("elsewhere")) == told
    whole = [session / f"trials/T{n:03d}.jsonl" for n in range(1, TRIALS + 1)]
    for folder in (f"{name}/S001", name, study.path.name):
        assert find_recordings(folder, out) == whole


NOTHING = (
    "quick-simulated/{}/S001/T099",
    "quick-simulated/NOBODY/T001",
    "nothing",
    "quick-simulated/{}/S001/journal",
    "T1",
    ".",
)


@pytest.mark.parametrize("name", NOTHING)
def test_what_is_not_there_is_refused_by_a_line_that_says_what_is(
    study: StudyFolder, session: Path, name: str
) -> None:
    wanted = name.format(session.parent.name)
    with pytest.raises(RecordingError, match=r"no such recording|has no recordings") as error:
        find_recordings(wanted, study.path.parent)
    assert "\n" not in str(error.value)
    assert "add --out" in str(error.value)


def test_all_trials_of_a_participant_are_compared_and_one_changed_state_is_told(
    study: StudyFolder, session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(study.path.parent)]
    name = f"{study.path.name}/{session.parent.name}"
    assert main(["replay", name, "--verify", *out]) == 0
    told = capsys.readouterr().out
    assert told.count("exact") == TRIALS and f"{TRIALS} recordings: all" in told
    lines = read_stored(session / "trials/T002.jsonl").data.split(b"\n")
    middle = next(i for i, line in enumerate(lines) if i > 4 and b'"hash":"' in line)
    before, after = lines[middle].split(b'"hash":"')
    lines[middle] = before + b'"hash":"' + bytes([after[0] ^ 1]) + after[1:]
    forged = tmp_path / "forged.jsonl"
    forged.write_bytes(b"\n".join(lines))
    assert main(["replay", str(forged)]) == 1
    assert "differs from physics step" in capsys.readouterr().out


def test_verification_fails_where_a_recording_breaks_off(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = read_stored(session / "trials/T002.jsonl").data.split(b"\n")
    torn = tmp_path / "torn.jsonl"
    torn.write_bytes(b"\n".join(lines[:-3]))
    assert main(["replay", str(torn)]) == 0
    assert main(["replay", str(torn), "--verify"]) == 1
    assert "breaks off" in capsys.readouterr().out


def test_a_damaged_compressed_recording_is_read_up_to_the_damage_and_says_so(
    session: Path, tmp_path: Path
) -> None:
    whole, path = packed(read_stored(session / "trials/T002.jsonl").data), tmp_path / "run.jsonl.gz"
    path.write_bytes(whole)
    told = load_recording(path)
    rng = np.random.default_rng(6)
    read = 0
    for i in range(150):
        data = bytearray(whole)
        if i % 2:
            data = data[: int(rng.uniform(0, len(whole)))]
        else:
            data[int(rng.uniform(10, len(whole)))] ^= 1 << int(rng.integers(8))
        path.write_bytes(data)
        try:
            found = load_recording(path)
        except RecordingError:
            continue
        read += 1
        # The last bytes tell the length and a checksum; what they are about is whole.
        assert found.damage or found.hashes == told.hashes
        assert found.damage or found.end == told.end
    assert read > 50


class Clock:
    """Time as one likes it."""

    def __init__(self) -> None:
        self.time = 0.0

    def __call__(self) -> float:
        return self.time


def row(count: int) -> list[Snapshot]:
    return [Snapshot(PERIOD * i, i, np.empty(0)) for i in range(count)]


@given(st.lists(st.tuples(st.floats(0.0, 3.0), st.integers(-200, 200), st.booleans()), max_size=20))
def test_whatever_one_does_there_is_something_to_see(doings: list[tuple[float, int, bool]]) -> None:
    clock = Clock()
    playback = Playback(row(50), 1.0, clock)
    for passed, moved, paused in doings:
        clock.time += passed
        playback.paused = paused
        playback.move(moved)
        assert 0 <= playback.now.step < 50


@pytest.mark.parametrize("speed", [1.0, 0.9, 0.5, 0.1, 2.0])
def test_who_looks_at_every_picture_of_a_screen_sees_the_whole_of_the_time(speed: float) -> None:
    clock = Clock()
    playback = Playback(row(10_000), speed, clock)
    for picture in range(1, 601):
        clock.time = picture / 60.0
        playback.move(0)
    assert playback.now.step == pytest.approx(10.0 * speed / PERIOD, abs=1.0)
