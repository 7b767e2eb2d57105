"""Nothing is asked or played before somebody has agreed; who declines leaves next to nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.simulated_study import simulated_person
from tests.support.study_driver import records, run, verify
from tests.support.study_files import SHORT, design

ASKED_OR_PLAYED = ("answer", "form", "trial", "trial_end")


def test_consent_comes_before_every_answer_and_trial(tmp_path: Path) -> None:
    kinds = [record["kind"] for record in records(run(tmp_path))]
    before = kinds[: kinds.index("consent")]
    assert not set(ASKED_OR_PLAYED) & set(before) and set(ASKED_OR_PLAYED) & set(kinds)


def test_who_declines_leaves_three_records_and_their_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SimulatedForms, "consent", lambda *args: False)
    folder = run(tmp_path)
    declined = records(folder)
    assert [record["kind"] for record in declined] == ["session", "consent", "end"]
    assert declined[1]["agreed"] is False and declined[2]["complete"] is False
    assert not list(folder.glob("*/S001/trials/*"))
    study = StudyFolder(tmp_path, design(SHORT), SIMULATED)
    (person,) = study.participants()
    assert study.is_released(person.ppid)
    assert study.add(**simulated_person(study.design, 1)).number == person.number
    assert verify(folder) == []
