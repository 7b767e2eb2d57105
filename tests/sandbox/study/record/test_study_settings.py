"""A study stores all settings of its trials when it begins."""

from __future__ import annotations

import json
from pathlib import Path

from sandbox.study.design.conditions import run_settings
from sandbox.study.record.folder import SIMULATED, STUDY_JOURNAL, StudyFolder
from sandbox.trial.settings import Settings, encoded
from tests.support.study_files import design


def test_a_default_that_changes_later_changes_no_trial_of_a_study_that_has_begun(
    tmp_path: Path,
) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    assert study.settings == Settings()
    first = json.loads((study.path / STUDY_JOURNAL).read_text().splitlines()[0])
    assert first["settings"] == json.loads(json.dumps(encoded(Settings())))
    before = Settings().changed(hover=0.05, impulse=0.5)
    later = run_settings({"impulse": "paper"}, 3, base=before)
    assert later.pipeline.hover == 0.05 and later.physics.impulse == 100.0
