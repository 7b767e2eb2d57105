"""On another machine a recording shows its own poses, and says that nothing promises more."""

from __future__ import annotations

import gc
import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from threadpoolctl import threadpool_info

from models.arithmetic import Array
from models.errors import RecordingError
from sandbox.cli import replay as replay_command
from sandbox.cli.common.command_line import parse
from sandbox.devices.device import AnyDevice
from sandbox.recording.recording import (
    GRAIN,
    PoseTrack,
    PoseTrackWriter,
    load_recording,
    read_track_line,
)
from sandbox.session.messages import Snapshot
from sandbox.session.session import STATE, Session
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import View, open_trial, play_trial
from sandbox.trial.replay import Verification, is_same_outcome, replay
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import recorded_settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.score import Score, Status

Recorded = tuple[dict[int, Snapshot], TrialResult, Path]
"""A trial's snapshots by step, its result and its recording."""


@pytest.fixture(scope="module")
def recorded(
    tmp_path_factory: pytest.TempPathFactory,
) -> Recorded:
    path = tmp_path_factory.mktemp("run") / "run.jsonl"
    chosen = trial_settings(TrialOptions(seed=11, fingers=3))
    seen: dict[int, Snapshot] = {}
    result = play_trial(
        chosen,
        device_makers(chosen),
        lambda session: [lambda snapshot: seen.__setitem__(snapshot.step, snapshot)],
        record=path,
    )
    return seen, result, path


def forged(path: Path, name: str, **settings: object) -> Path:
    """The recording as if another machine had made it; with other settings as if that machine
    computed other states."""
    lines = path.read_text().splitlines()
    header = json.loads(lines[0])
    header["versions"] |= {"fingerprint": "another machine", "libm": "musl 1.2, 0123456789ab"}
    header["settings"]["physics"] |= settings
    other = path.with_name(name)
    other.write_text("\n".join([json.dumps(header), *lines[1:]]) + "\n")
    return other


def shown(path: Path) -> tuple[dict[int, Snapshot], Verification]:
    seen: dict[int, Snapshot] = {}
    _, found = replay(
        load_recording(path), lambda s: [lambda snapshot: seen.__setitem__(snapshot.step, snapshot)]
    )
    return seen, found


@pytest.mark.parametrize(
    "words",
    [
        "box-to-goal --device leap-simulated --seed 4",
        "box-to-goal --seed 5 --hand left --turn 90 --drop-outs 1",
        "stack --seed 3",
        "stack-vertical --seed 3 --hand left --fingers 2",
        "slalom --seed 6001 --solid hand",
        "carry-together --seed 3",
        "box-to-goal --seed 6 --vary size=0.9,mass=2,friction=0.8,start=10,hand-size=1.05",
        "box-to-goal --seed 6 --vary noise=0.5,dropped=1,ghosts=1,latency=30",
    ],
)
def test_the_recording_of_any_trial_replays_to_the_bit_with_its_settings(
    words: str, tmp_path: Path
) -> None:
    chosen = trial_settings(parse(TrialOptions, "sandbox run", words.split()))
    result = play_trial(chosen, record=tmp_path / "run.jsonl")
    recording = load_recording(tmp_path / "run.jsonl")
    session, found = replay(recording)
    assert found.exact and found.complete and found.same_machine and found.compared > 100
    assert session.state_hash == result.state_hash
    assert recorded_settings(recording.header) == chosen


def test_a_replay_runs_undisturbed_and_ends_with_its_devices_closed(recorded: Recorded) -> None:
    disturbed: list[str] = []

    def watch(snapshot: Snapshot) -> None:
        if gc.isenabled():
            disturbed.append("the garbage collector is on")
        disturbed.extend(pool["filepath"] for pool in threadpool_info() if pool["num_threads"] > 1)

    assert gc.isenabled()
    session, found = replay(load_recording(recorded[2]), lambda session: [watch])
    assert found.exact and not disturbed and gc.isenabled()
    assert is_closed(session.rigs[0].device)


def is_closed(device: AnyDevice) -> bool:
    """True if a device that plays a recording is closed: it has no further frame at any time."""
    return device.finished and not device.poll(0.0)


def test_a_replay_whose_view_fails_closes_its_devices(recorded: Recorded) -> None:
    sessions: list[Session] = []

    def fails(snapshot: Snapshot) -> None:
        raise OSError("no room")

    def views(session: Session) -> list[View]:
        sessions.append(session)
        return [fails]

    def no_view(session: Session) -> list[View]:
        sessions.append(session)
        raise OSError("no window")

    for make in (views, no_view):
        with pytest.raises(OSError, match="no "):
            replay(load_recording(recorded[2]), make)
    assert len(sessions) == 2 and all(is_closed(each.rigs[0].device) for each in sessions)


def test_a_simulation_goes_on_from_a_keyframe_whatever_was_simulated_before(
    recorded: Recorded,
) -> None:
    recording = load_recording(recorded[2])
    chosen = recorded_settings(recording.header)
    session = build(chosen, device_makers(chosen))
    model, data = session.scene.model, session.data
    assert len(recording.keyframes) > 2
    for step, state in recording.keyframes.items():
        ends = []
        for _ in range(2):
            mujoco.mj_setState(model, data, state, STATE)
            assert data.time == pytest.approx(step * model.opt.timestep)
            again = np.empty_like(state)
            mujoco.mj_getState(model, data, again, STATE)
            assert again.tobytes() == state.tobytes()
            mujoco.mj_step(model, data, 50)
            ends.append(data.qpos.tobytes())
            data.qvel[:] = 1.0
            mujoco.mj_step(model, data, 3)
        assert ends[0] == ends[1]


def test_elsewhere_every_recorded_pose_is_shown_though_the_simulation_differs(
    recorded: Recorded,
) -> None:
    seen, result, path = recorded
    # A weak hand: this machine computes another trial from the same touches.
    again, found = shown(forged(path, "weak.jsonl", impulse=0.02))
    assert found.first_difference is not None and not found.same_machine and found.shown_recorded
    steps = sorted(set(seen) & set(again))
    # The state after the very last control period is not in the track.
    assert max(seen) - max(steps) <= 8 and len(steps) > 100
    for step in [s for s in steps if s != max(seen)]:
        was, now = seen[step], again[step]
        np.testing.assert_allclose(now.qpos, was.qpos, atol=2 * GRAIN)
        # A live snapshot's places are those of the last physics step but one, 2 ms before.
        for a, b in (
            (now.objects["box"].position, was.objects["box"].position),
            (now.hands[0].tips, was.hands[0].tips),
        ):
            np.testing.assert_allclose(a, b, atol=3e-3)
        assert now.hands[0].solid == was.hands[0].solid
    assert result.success and again[max(again)].score.status in ("held", "running")


def test_elsewhere_the_command_says_so_and_does_not_fail(
    recorded: Recorded, capsys: pytest.CaptureFixture[str]
) -> None:
    _, result, path = recorded
    assert replay_command.main([str(forged(path, "other.jsonl", impulse=0.02))]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert (
        "the system's libm (musl 1.2, 0123456789ab there" in said and "the recorded poses" in said
    )
    assert "disagrees" in said and "bounds" in said
    assert result.success
    assert f"box-to-goal: done after {result.time_s:.1f} s" in said


@pytest.mark.parametrize(
    ("recorded_as", "replayed_as", "at_its_end", "same"),
    [
        ("timeout", Score(status=Status.INPUT_ENDED), True, True),
        ("running", Score(status=Status.INPUT_ENDED), True, True),
        ("timeout", Score(status=Status.INPUT_ENDED), False, False),
        ("timeout", Score(held=True, status=Status.HELD), True, False),
        ("failed", Score(status=Status.INPUT_ENDED), True, False),
        ("input_ended", Score(status=Status.TIMEOUT), True, False),
        ("timeout", Score(status=Status.TIMEOUT), True, True),
    ],
)
def test_a_trial_that_was_ended_from_outside_has_the_same_outcome_where_its_input_ends(
    recorded_as: str, replayed_as: Score, at_its_end: bool, same: bool
) -> None:
    recorded = {"status": recorded_as, "success": False}
    assert is_same_outcome(replayed_as, recorded, at_its_end) is same


def test_a_trial_that_was_left_is_called_broken_off_by_its_replay(
    recorded: Recorded, capsys: pytest.CaptureFixture[str]
) -> None:
    path = recorded[2].with_name("left.jsonl")
    chosen = trial_settings(TrialOptions(seed=11, fingers=3))
    with open_trial(chosen, record=path) as trial:
        for _ in range(60):
            trial.step()
        trial.end()
    assert replay_command.main([str(path)]) == 0
    assert "broken off after" in capsys.readouterr().out
    other = forged(path, "left-elsewhere.jsonl")
    lines = other.read_text().splitlines()
    first = next(found["hash"] for found in map(json.loads, lines[1:]) if "hash" in found)
    other.write_text("\n".join(lines).replace(first, "0" * len(first)) + "\n")
    assert replay_command.main([str(other), "--verify"]) == 0
    assert "the same outcome" in capsys.readouterr().out


def test_poses_of_another_scene_are_refused_in_one_line(recorded: Recorded) -> None:
    _, _, path = recorded
    lines = forged(path, "scene.jsonl").read_text().splitlines()
    lines = [t for t in lines if '"kind":"track"' not in t]
    track = PoseTrackWriter()
    track.add(0, np.zeros(3), [frozenset()])
    other = path.with_name("other-scene.jsonl")
    other.write_text("\n".join([*lines, json.dumps(track.line())]) + "\n")
    with pytest.raises(RecordingError, match="another scene"):
        replay(load_recording(other))


@given(
    qpos=hnp.arrays(
        float,
        st.tuples(st.integers(1, 150), st.integers(1, 9)),
        elements=st.floats(-100.0, 100.0) | st.sampled_from([np.nan, np.inf, -np.inf]),
    ),
    first=st.integers(0, 10**6),
    stride=st.integers(1, 16),
    fingers=st.frozensets(st.integers(0, 4)),
)
def test_a_track_keeps_every_finite_position_to_its_grain(
    qpos: Array, first: int, stride: int, fingers: frozenset[int]
) -> None:
    writer, track = PoseTrackWriter(), PoseTrack()
    for i, row in enumerate(qpos):
        writer.add(first + i * stride, row, [fingers, frozenset()])
    line = json.loads(json.dumps(writer.line()))
    assert writer.line() is None
    read_track_line(line, track)
    assert sorted(track.qpos) == [first + i * stride for i in range(len(qpos))]
    for i, row in enumerate(qpos):
        got = track.qpos[first + i * stride]
        finite = np.isfinite(row)
        np.testing.assert_allclose(got[finite], row[finite], atol=0.51 * GRAIN)
        assert np.all(np.isfinite(got))
        assert track.solid[first + i * stride] == (fingers, frozenset())


@pytest.mark.parametrize(
    "spoil",
    [
        {"steps": [0, 8, 10**9]},
        {"steps": [0, 8, 3]},
        {"joints": -5},
        {"hands": 99},
        {"poses": "AAAA"},
        {"poses": "***"},
    ],
)
def test_a_damaged_track_ends_the_recording_and_is_named(
    tmp_path: Path, spoil: dict[str, Any]
) -> None:
    writer = PoseTrackWriter()
    for i in range(4):
        writer.add(8 * i, np.arange(5.0), [frozenset({1})])
    header = {"kind": "header", "schema": 2, "settings": {}}
    path = tmp_path / "damaged.jsonl"
    path.write_text("\n".join(json.dumps(t) for t in (header, {**writer.line(), **spoil})) + "\n")
    assert "line 2 is damaged" in load_recording(path).damage
