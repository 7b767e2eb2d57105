"""What other instruments get over Lab Streaming Layer is what the recording holds."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from sandbox.cli.main import main
from sandbox.lsl import (
    CONTACTS,
    TOUCH_CHANNELS,
    LslOutlets,
    forwarding_to,
    hand_sample,
    send_event,
    touch_sample,
)
from sandbox.recording.recording import Recording, load_recording
from sandbox.session.messages import Snapshot
from sandbox.study.run.simulated_study import run_simulated
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.study_files import TRIALS, open_study

SCENE = TrialOptions(task="tests/support/regress_tasks.py:Quick", seed=4, encoder="linear")
HERE = "[multicast]\nResolveScope = machine\n[lab]\nKnownPeers = {127.0.0.1}\n"
"""Streams are looked for on this machine alone; the network's other ends are not ours."""


@pytest.fixture(scope="module", autouse=True)
def here(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Reads liblsl's settings from a file of ours; it does so once, at its first use."""
    path = tmp_path_factory.mktemp("settings") / "lsl_api.cfg"
    path.write_text(HERE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LSLAPICFG", str(path))
        yield


@pytest.fixture(scope="module")
def heard(
    tmp_path_factory: pytest.TempPathFactory, here: None
) -> tuple[list[dict[str, Any]], Recording]:
    """What a reader in another process has got of a trial, and the trial's recording."""
    folder = tmp_path_factory.mktemp("lsl")
    outlets = LslOutlets()
    reader = subprocess.Popen(
        [
            sys.executable,
            str(Path(__file__).with_name("lsl_reader.py")),
            outlets.source,
            str(folder / "heard.jsonl"),
        ]
    )
    try:
        assert outlets.wait_for_consumers(60.0)
        chosen = trial_settings(SCENE)
        with forwarding_to(outlets):
            send_event("break", {"least_s": 3})
            play_trial(chosen, record=folder / "trial.jsonl")
        assert reader.wait(60.0) == 0
    finally:
        reader.kill()
        outlets.close()
    lines = (folder / "heard.jsonl").read_text().splitlines()
    return [json.loads(line) for line in lines], load_recording(folder / "trial.jsonl")


def samples(heard: list[dict[str, Any]], stream: str) -> list[list[Any]]:
    return [h["sample"] for h in heard if h["stream"] == stream and "sample" in h]


Heard = tuple[list[dict[str, Any]], Recording]


def test_touches_that_were_sent_are_those_of_the_recording_to_the_bit(heard: Heard) -> None:
    lines, recording = heard
    found = np.array(samples(lines, "sandbox_touch"))
    inputs: list[Any] = list(recording.inputs[0])
    assert len(found) == len(inputs) > 5
    for sample, line in zip(found, inputs, strict=True):
        assert np.array_equal(
            sample, touch_sample(line.step, line.frame.time, line.frame), equal_nan=True
        )


def test_poses_that_were_sent_are_those_that_the_recording_replays_to(heard: Heard) -> None:
    lines, recording = heard
    shots: list[Snapshot] = []
    replay(recording, lambda session: [shots.append])
    wanted = [hand_sample(s.step, s.time, s.hands[0].target) for s in shots]
    assert np.array_equal(np.array(samples(lines, "sandbox_hand")), np.array(wanted))


def test_markers_tell_the_trial_and_what_happens_between_trials(heard: Heard) -> None:
    lines, recording = heard
    told = [json.loads(sample[0]) for sample in samples(lines, "sandbox_markers")]
    assert [t["event"] for t in told] == ["break", "trial_start", "trial_end"]
    assert told[1]["seed"] == 4 and told[1]["task"] == recording.header["settings"]["task"]
    assert recording.end is not None
    assert told[2]["state_hash"] == recording.end["hash"]


def test_the_recording_says_how_the_clocks_stand_and_replays_to_the_same_states(
    heard: Heard,
) -> None:
    lines, recording = heard
    clocks = [e.details for e in recording.events if e.what == "clock"]
    assert len(clocks) >= 2
    offset = clocks[-1]["lsl_minus_monotonic_s"]
    (end,) = [h["stamp"] for h in lines if "trial_end" in str(h.get("sample"))]
    # The reader's stamps are the sender's: same machine, one LSL clock.
    first, last = clocks[0]["monotonic_s"] + offset, clocks[-1]["monotonic_s"] + offset
    stamps = [h["stamp"] for h in lines if h["stream"] == "sandbox_hand" and "stamp" in h]
    assert first <= min(stamps) + 1e-3 and max(stamps) <= last + 1e-3 <= end + 2e-3
    assert stamps == sorted(stamps)
    _, found = replay(recording)
    assert found.exact and found.complete


def test_listening_changes_no_state_of_a_trial(heard: Heard, tmp_path: Path) -> None:
    chosen = trial_settings(SCENE)
    result = play_trial(chosen)
    assert heard[1].end is not None and heard[1].end["hash"] == result.state_hash


contacts = st.builds(
    Contact,
    id=st.integers(0, 10**6),
    x=st.floats(-1, 1),
    y=st.floats(-1, 1),
    size=st.none() | st.floats(0, 0.1),
    label=st.none() | st.integers(0, 4),
)


@given(st.lists(contacts, max_size=14, unique_by=lambda c: c.id))
def test_a_touch_sample_tells_every_contact_up_to_ten(found: list[Contact]) -> None:
    sample = touch_sample(8, 0.016, TouchFrame(0.016, tuple(found)))
    named = dict(zip(TOUCH_CHANNELS, sample, strict=True))
    assert (named["step"], named["time"]) == (8, 0.016)
    told = sorted(found, key=lambda c: c.id)[:CONTACTS]
    for i in range(CONTACTS):
        if i >= len(told):
            assert math.isnan(named[f"id_{i}"])
            continue
        contact = told[i]
        assert (named[f"id_{i}"], named[f"x_{i}"], named[f"y_{i}"]) == (
            contact.id,
            contact.x,
            contact.y,
        )
        assert math.isnan(named[f"finger_{i}"]) == (contact.label is None)


def test_two_hands_have_streams_of_their_own() -> None:
    outlets = LslOutlets()
    for hand in (0, 1, 1):
        outlets.pose(8, 0.016, hand, np.zeros(48))
        outlets.input(8, 0.016, hand, TouchFrame(0.016))
    streams = outlets._streams
    outlets._queue.put(None)
    outlets._thread.join()
    assert set(streams) == {
        "sandbox_touch",
        "sandbox_hand",
        "sandbox_markers",
        "sandbox_touch_2",
        "sandbox_hand_2",
    }


def test_a_command_that_streams_plays_the_same_trial_and_writes_the_clocks_down(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "t.jsonl"
    words = ["run", SCENE.task, "--seed", "4", "--encoder", "linear"]
    assert main([*words, "--lsl", "--record", str(path)]) == 0
    assert "LSL: sandbox_touch, sandbox_hand, sandbox_markers" in capsys.readouterr().out
    recording = load_recording(path)
    assert [e.what for e in recording.events] == ["clock", "clock"]
    assert main(words) == 0
    assert recording.end is not None and recording.end["hash"] in capsys.readouterr().out


def test_other_instruments_hear_of_a_study_what_happens_and_nothing_that_was_said(
    tmp_path: Path,
) -> None:
    heard: list[tuple[str, dict[str, Any]]] = []

    class Ear(LslOutlets):
        def event(self, what: str, details: Mapping[str, Any]) -> None:
            heard.append((what, dict(details)))

    ear = Ear()
    study = open_study(tmp_path)
    with forwarding_to(ear):
        run_simulated(study, 1, lambda text: None)
    ear.close()
    kinds = [what for what, _ in heard]
    assert kinds[0] == "journal_session" and kinds[-2:] == ["journal_end", "sealed"]
    (seal,) = [r for r in study.records() if r["kind"] == "sealed"]
    assert heard[-1][1]["hash"] == seal["hash"]
    assert kinds.count("journal_trial_end") == kinds.count("trial_end") == TRIALS
    known = {"n", "step", "trial", "attempt", "practice", "form", "block", "levels", "command"}
    assert all(set(d) <= known for what, d in heard if what.startswith("journal_"))


def test_what_cannot_be_sent_ends_no_stream_and_is_told_at_the_end() -> None:
    outlets = LslOutlets()
    outlets.event("measured", {"good": np.bool_(True)})
    for step in range(3):
        outlets.event("measured", {"step": step})
    with pytest.raises(DeviceError, match=r"--lsl.*1 samples or markers lost.*JSON"):
        outlets.close()


def test_without_pylsl_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    with pytest.raises(DeviceError, match=r"hand-sandbox\[lsl\]"):
        LslOutlets()
