"""A study that two simulated people have finished, played once for all tests of a process."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.run.simulated_study import simulate
from tests.support.study_files import design, quiet


@pytest.fixture(scope="session")
def two_people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the study, in which nothing may be changed."""
    study = StudyFolder(tmp_path_factory.mktemp("two people"), design(), SIMULATED)
    simulate(study, 2, False, quiet)
    return study.path


@pytest.fixture
def study(two_people: Path, tmp_path: Path) -> StudyFolder:
    """A copy of the study, for one test."""
    shutil.copytree(two_people, tmp_path / "out" / two_people.name)
    return StudyFolder.at(tmp_path / "out" / two_people.name)
