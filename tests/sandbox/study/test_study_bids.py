"""A Motion-BIDS data set holds what was recorded, and says of it what the specification asks."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.errors import StudyError
from models.frames import FINGERS, TouchFrame
from models.scene import CONTROL_PERIOD, SceneSpec
from models.skeleton import ADULT
from sandbox.recording.recording import load_recording
from sandbox.session.messages import Snapshot
from sandbox.study.design.design_file import parse_design
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.run.simulate import run_simulated
from sandbox.study.share.bids import export_bids, task_label
from sandbox.study.share.privacy import Masking, anonymise
from sandbox.trial.replay import replay
from tests.support.study_files import DESIGN, TRIALS, design

NAME = re.compile(
    r"sub-[0-9A-Z]+_task-[A-Za-z0-9]+_tracksys-[a-z]+_run-\d+_"
    r"(motion\.tsv|motion\.json|channels\.tsv|channels\.json|events\.tsv|events\.json)$"
)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    found = StudyFolder(tmp_path_factory.mktemp("study"), design(DESIGN), SIMULATED)
    run_simulated(found, 0, lambda text: None)
    return found


@pytest.fixture(scope="module")
def bids(study: StudyFolder, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("shared") / "bids"
    # Two of the six are practice.
    assert export_bids(study, out, lambda text: None) == TRIALS - 2
    return out


def table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.open(encoding="utf-8"), delimiter="\t"))


def test_files_are_named_and_told_of_as_the_specification_asks(bids: Path) -> None:
    about = json.loads((bids / "dataset_description.json").read_text())
    assert about["Name"] and about["BIDSVersion"] and about["DatasetType"] == "raw"
    assert "simulated" in about["Name"] and (bids / "README").stat().st_size > 150
    files = list(next(bids.glob("sub-*/motion")).iterdir())
    assert len(files) == 6 * (TRIALS - 2) and all(NAME.match(p.name) for p in files)
    people = table(bids / "participants.tsv")
    assert [f"{p['participant_id']}" for p in people] == [p.name for p in bids.glob("sub-*")]
    columns = json.loads((bids / "participants.json").read_text())
    assert set(people[0]) == {"participant_id", *columns} and "age" in columns


def test_channels_describe_every_column_of_a_motion_file(bids: Path) -> None:
    for path in bids.rglob("*_motion.tsv"):
        stem = str(path).removesuffix("_motion.tsv")
        data = np.loadtxt(path, delimiter="\t")
        channels = table(Path(f"{stem}_channels.tsv"))
        about = json.loads(Path(f"{stem}_motion.json").read_text())
        assert list(channels[0])[:5] == ["name", "component", "type", "tracked_point", "units"]
        assert data.shape[1] == len(channels) == about["MotionChannelCount"]
        kinds = [c["type"] for c in channels]
        assert about["POSChannelCount"] == kinds.count("POS")
        assert about["ORNTChannelCount"] == kinds.count("ORNT") == len(kinds) - kinds.count("POS")
        assert about["RecordingDuration"] == pytest.approx(len(data) / 62.5, abs=1e-6)
        assert len({c["name"] for c in channels}) == len(channels)
        levels = json.loads(Path(f"{stem}_channels.json").read_text())["reference_frame"]["Levels"]
        assert {c["reference_frame"] for c in channels} <= set(levels)
        turns = data[:, [c["component"].startswith("quat") for c in channels]].reshape(-1, 4)
        assert np.allclose(np.linalg.norm(turns, axis=1), 1.0, atol=1e-4)


def test_motion_is_what_the_recording_replays(study: StudyFolder, bids: Path) -> None:
    shots: list[Snapshot] = []
    # T001 is practice; the first run is T002.
    recording = next(study.path.glob("*/S001/trials/T002.jsonl.gz"))
    replay(load_recording(recording), lambda session: [shots.append])
    motion = next(bids.rglob("*_run-1_motion.tsv"))
    channels = table(Path(str(motion).replace("_motion.tsv", "_channels.tsv")))
    data = np.loadtxt(motion, delimiter="\t")
    names = [c["name"] for c in channels]
    wanted = np.array([s.hands[0].target for s in shots])
    assert len(data) == len(wanted)
    at = [names.index(f"hand_pos_{a}") for a in "xyz"]
    assert np.allclose(data[:, at], wanted[:, :3], atol=1e-5)
    for i, bone in enumerate(("hand", *(b.name for b in ADULT.bones))):
        at = [names.index(f"{bone}_quat_{a}") for a in "xyzw"]
        found = Rotation.from_quat(data[:, at])
        told = Rotation.from_rotvec(wanted[:, 3 + 3 * i : 6 + 3 * i])
        assert (found * told.inv()).magnitude().max() < 2e-4
    for name, view in shots[-1].objects.items():
        at = [names.index(f"{name}_pos_{a}") for a in "xyz"]
        assert np.allclose(data[-1, at], view.position, atol=1e-5)


def test_events_are_the_trial_and_every_touch(study: StudyFolder, bids: Path) -> None:
    recording = load_recording(next(study.path.glob("*/S001/trials/T002.jsonl.gz")))
    down: dict[int, list[int]] = {}
    for entry in recording.inputs[0]:
        assert isinstance(entry.frame, TouchFrame)
        for contact in entry.frame.contacts:
            down.setdefault(contact.id, []).append(entry.step)
    assert len(down) > 1
    events = table(next(bids.rglob("*_run-1_events.tsv")))
    assert list(events[0])[:2] == ["onset", "duration"]
    trial, *touches = events
    assert trial["trial_type"] == "trial" and trial["factor_contact"] in ("hard", "soft")
    assert recording.end is not None
    assert float(trial["duration"]) == pytest.approx(recording.end["result"]["time_s"])
    # Time 0 is that of the first row of the motion, a control period into the trial.
    assert float(trial["onset"]) == pytest.approx(-CONTROL_PERIOD)
    assert [int(e["contact"]) for e in touches] == sorted(down, key=lambda i: down[i][0])
    for touch in touches:
        first, *_, last = (SceneSpec.timestep * step for step in down[int(touch["contact"])])
        assert float(touch["onset"]) == pytest.approx(first, abs=1e-6)
        assert float(touch["duration"]) == pytest.approx(last - first, abs=1e-6)
        assert touch["finger"] in FINGERS


def test_rules_exclude_the_same_trials_as_in_the_tables_of_the_study(tmp_path: Path) -> None:
    # Of the 60 Hz tables, which the session's folder has.
    rule = '[[exclusions]]\nname = "moved"\nmeasure = "object_path_m"\nbelow = 1e9\n'
    study = StudyFolder(tmp_path / "study", design(DESIGN + rule), SIMULATED)
    run_simulated(study, 0, lambda text: None)
    export_bids(study, tmp_path / "bids", lambda text: None)
    events = [e for path in (tmp_path / "bids").rglob("*_events.tsv") for e in table(path)]
    assert {e["excluded"] for e in events if e["trial_type"] == "trial"} == {"1"}


OLD = ("complete", "hand", "number", "participant_id")


def test_no_answer_changes_a_column_of_a_person_that_the_program_fills(tmp_path: Path) -> None:
    # A design of before such names were refused.
    item = '[[demographics]]\nname = "NAME"\nkind = "number"\nlow = 18\nask = "?"\n'
    text = DESIGN.replace('name = "effort"\nat', 'name = "demographics"\nat').replace(
        "[[questionnaires]]\n",
        "".join(item.replace("NAME", name) for name in OLD) + "[[questionnaires]]\n",
    )
    begun = parse_design(text, Path("design.toml"), try_out=False)
    study = StudyFolder(tmp_path / "made", begun, SIMULATED)
    run_simulated(study, 0, lambda said: None)
    export_bids(study, tmp_path / "bids", lambda said: None)
    anonymise(study, tmp_path / "copy", Masking(), lambda said: None)
    files = (study.path / "participants.csv", tmp_path / "copy" / "participants.csv")
    for path in files:
        head, row = csv.reader(path.open(encoding="utf-8"))
        person = dict(zip(head, row, strict=True))
        assert len(set(head)) == len(head)
        assert person["hand"] in ("left", "right") and person["complete"] == "1"
        assert person["number"] == "0" and float(person["age"]) >= 18
    assert [
        p["instrument"] for p in csv.DictReader(files[0].with_name("questionnaires.csv").open())
    ][:5] == ["demographics"] * 5
    head, row = csv.reader((tmp_path / "bids" / "participants.tsv").open(), delimiter="\t")
    person = dict(zip(head, row, strict=True))
    assert len(set(head)) == len(head) and person["participant_id"].startswith("sub-")
    assert person["hand"] in ("left", "right") and float(person["age"]) >= 18


@pytest.mark.parametrize(
    ("task", "label"),
    [("box-to-goal", "boxToGoal"), ("stack", "stack"), ("own/task.py:Quick", "ownTaskPyQuick")],
)
def test_a_task_is_named_in_letters_and_digits(task: str, label: str) -> None:
    assert task_label(task) == label


def test_a_study_without_trials_is_refused_and_nothing_is_written_over(
    study: StudyFolder, bids: Path, tmp_path: Path
) -> None:
    empty = StudyFolder(tmp_path / "empty", design(), SIMULATED)
    with pytest.raises(StudyError, match="no finished trial"):
        export_bids(empty, tmp_path / "bids", lambda text: None)
    assert not (tmp_path / "bids").exists()
    with pytest.raises(StudyError, match="exists already"):
        export_bids(study, bids, lambda text: None)
