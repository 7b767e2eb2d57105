"""What a study is locked to: all that takes part in a trial or makes measures, and nothing else."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.recording.versions import DECISIVE
from sandbox.study.design.conditions import run_settings
from sandbox.study.record import build as build_module
from sandbox.study.record.build import (
    COMPUTES,
    LEFT_OUT,
    NOTED,
    OWN_TASKS,
    changes,
    digest_of,
    noted_changes,
)
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.notes import ANEW
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.share.shared_folder import Masking, share_study
from sandbox.study.share.verify import verify
from sandbox.study.tables.tables import make_tables
from sandbox.trial.settings import Settings, encoded
from tests.support.import_graph import ROOT, import_graph, modules
from tests.support.study_files import DESIGN, design, open_study, quiet, rows_of

BEGIN = (
    "sandbox/trial",
    "tasks",
    "sandbox/session",
    "sandbox/recording",
    "sandbox/devices",
    "sandbox/study/run",
    "sandbox/study/record",
    "sandbox/study/measures",
    "sandbox/study/tables",
)
"""Rooms that take part in a trial of a study or make measures of it."""


def reached() -> set[str]:
    """Folders of all modules that these rooms import, directly or not."""
    folders = {name: path.parent.relative_to(ROOT).as_posix() for name, path in modules().items()}
    graph = import_graph()
    left = [
        name
        for name, folder in folders.items()
        if any(f"{folder}/".startswith(f"{room}/") for room in BEGIN)
    ]
    seen = set(left)
    while left:
        new = graph[left.pop()] - seen
        seen |= new
        left += new
    return {folders[name] for name in seen}


def test_every_folder_that_a_trial_reaches_is_in_the_digest_or_is_left_out_with_a_reason() -> None:
    found = reached()
    assert not set(COMPUTES) & set(LEFT_OUT) and all(LEFT_OUT.values())
    assert found - set(COMPUTES) - set(LEFT_OUT) == set(), "name them in COMPUTES or LEFT_OUT"
    assert {*COMPUTES, *LEFT_OUT} - found == set(), "nothing reaches these any more"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    copy = tmp_path_factory.mktemp("program")
    for package in ("models", "encoders", "tasks", "sandbox"):
        shutil.copytree(
            ROOT / package,
            copy / package,
            ignore=shutil.ignore_patterns("node_modules", "static", "__pycache__", "*.npz"),
        )
    return copy


@pytest.mark.parametrize(
    ("file", "noticed"),
    [
        ("models/hand.xml", True),
        ("tasks/slalom.py", True),
        ("sandbox/study/tables/frame_table.py", True),
        ("sandbox/server/page_server.py", False),
        ("sandbox/study/report/make.py", False),
    ],
)
def test_a_changed_line_is_noticed_where_it_takes_part_in_a_trial(
    program: Path, file: str, noticed: bool
) -> None:
    before, path = digest_of(program), program / file
    text = path.read_bytes()
    path.write_bytes(text + b"\n")
    assert (digest_of(program) != before) is noticed
    path.write_bytes(text)
    assert digest_of(program) == before


@pytest.mark.parametrize("name", NOTED)
def test_another_version_on_which_no_state_depends_is_noted_and_needs_no_force(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    first = open_study(tmp_path)
    other = {**first.build, name: "99.1"}
    monkeypatch.setattr("sandbox.study.record.folder.build_of", lambda _: other)
    study = open_study(tmp_path)
    (said,) = study.noted
    assert said.startswith(name) and "99.1" in said and study.build == other
    record = study.records()[-1]
    assert (record["kind"], record["changed"]) == ("libraries", [said])
    assert (record["before"][name], record["after"][name]) == (first.build[name], "99.1")
    count = len(study.records())
    assert open_study(tmp_path).noted == []
    assert len(study.records()) == count


@pytest.mark.parametrize("name", DECISIVE)
def test_another_version_that_states_depend_on_is_refused_unless_forced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    first = open_study(tmp_path)
    first.add()
    other = {**first.build, name: "musl 1.2, 0123456789ab", "numpy": "99.1"}
    monkeypatch.setattr("sandbox.study.record.folder.build_of", lambda _: other)
    with pytest.raises(StudyError, match=rf"{name} .*force-upgrade"):
        open_study(tmp_path)
    assert first.build == StudyFolder.at(first.path).build
    study = StudyFolder(tmp_path, design(), SIMULATED, "another laboratory")
    record = study.records()[-1]
    assert record["kind"] == "upgrade" and [c.split()[0] for c in record["changed"]] == [
        name,
        "numpy",
    ]


def test_a_study_in_which_nobody_has_taken_part_is_locked_anew_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A design that was mended after the first try was refused, though nothing depended on it."""
    first = open_study(tmp_path)
    text = DESIGN.replace("repetitions = 2", "repetitions = 3")
    study = open_study(tmp_path, text)
    assert [changed.split()[0] for changed in study.anew] == ["design"]
    assert study.build == StudyFolder.at(study.path).build != first.build
    assert (study.path / "design.toml").read_text() == text
    record = study.records()[-1]
    assert (record["kind"], record["before"], record["after"]) == (ANEW, first.build, study.build)
    study.add()
    assert open_study(tmp_path, text).anew == []
    with pytest.raises(StudyError, match=r"design .*--out FOLDER"):
        open_study(tmp_path)


def test_nobody_is_added_by_a_design_to_which_the_study_is_no_longer_locked(tmp_path: Path) -> None:
    first = open_study(tmp_path)
    second = open_study(tmp_path, DESIGN.replace("repetitions = 2", "repetitions = 3"))
    with pytest.raises(StudyError, match="locked the study to other values"):
        first.add()
    assert first.participants() == [] and second.add().number == 1


def test_another_version_of_libm_with_equal_values_is_equal() -> None:
    before = {"libm": "glibc 2.36, 0123456789ab"}
    assert changes(before, {"libm": "glibc 2.41, 0123456789ab"}) == []
    assert changes(before, {"libm": "glibc 2.36, ba9876543210"}) != []
    assert noted_changes(before, {"libm": "glibc 2.41, 0123456789ab"}) == []


def test_a_study_from_before_tasks_of_ones_own_were_locked_goes_on() -> None:
    here = build_module.build_of(design())
    before = {name: value for name, value in here.items() if name != OWN_TASKS}
    assert changes(before, here) == []


def test_a_design_that_is_replaced_is_kept_and_the_sessions_run_by_it_still_have_it(
    tmp_path: Path,
) -> None:
    """It was overwritten, and tables of sessions of before named the new one or were "changed"."""
    first = open_study(tmp_path)
    run_simulated(first, 1, quiet)
    text = DESIGN.replace("repetitions = 2", "repetitions = 3").replace("step = 5", "step = 10")
    study = StudyFolder(tmp_path, design(text), SIMULATED, "more trials")
    assert (study.path / "design.toml").read_text() == text
    assert StudyFolder.at(study.path).design_of(first.design.digest).text == DESIGN
    make_tables(study)
    (row,) = rows_of(study.path / "tables/participants.csv")
    assert (row["trials_done"], row["trials_planned"]) == ("6", "6")
    assert verify(study.path, replays=False).sound
    assert open_study(tmp_path, text).session_designs() == [first.design.digest]
    share_study(study, tmp_path / "shared", Masking(), quiet)
    assert StudyFolder.at(tmp_path / "shared").design_of(first.design.digest).text == DESIGN
    assert verify(tmp_path / "shared", replays=False).sound


def test_a_default_that_changes_later_changes_no_trial_of_a_study_that_has_begun(
    tmp_path: Path,
) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    assert study.settings == Settings()
    first = json.loads(study.notes.read_text().splitlines()[0])
    assert first["settings"] == json.loads(json.dumps(encoded(Settings())))
    before = Settings().changed(hover=0.05, impulse=0.5)
    later = run_settings({"impulse": "paper"}, 3, base=before)
    assert later.pipeline.hover == 0.05 and later.physics.impulse == 100.0
