"""A copy of a folder inside of a study is no data: no trial counts twice, and it is named."""

from __future__ import annotations

import shutil

import pytest

from sandbox.cli.main import main
from sandbox.study.record.folder import StudyFolder
from sandbox.study.share.verify import verify
from tests.support.study_files import rows_of


@pytest.fixture
def copied(study: StudyFolder) -> StudyFolder:
    """A study with a copy of a person's folder and a copy of another one's session."""
    one, other = (person.ppid for person in study.participants())
    shutil.copytree(study.path / one, study.path / f"{one} copy")
    shutil.copytree(study.path / other / "S001", study.path / other / "S002")
    return study


def names(study: StudyFolder) -> list[str]:
    """Sentences about both copies."""
    one, other = (person.ppid for person in study.participants())
    return [f"{one} copy is a copy of {one};", f"{other}/S002 is a copy of {other}/S001;"]


def tables(study: StudyFolder) -> dict[str, list[dict[str, str]]]:
    return {path.name: rows_of(path) for path in (study.path / "tables").glob("*.csv")}


def test_copies_change_no_table_and_are_named(
    copied: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tables(copied)
    assert main(["study", "tables", str(copied.path)]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in names(copied))
    assert tables(copied) == before and len(copied.participants()) == 2


def test_verification_names_copies_and_fails_and_is_right_again_without_them(
    copied: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(copied.path), "--verify"]) == 1
    printed = capsys.readouterr().out
    assert all(name.replace(" is a", ": is a") in printed for name in names(copied))
    one, other = (person.ppid for person in copied.participants())
    shutil.rmtree(copied.path / f"{one} copy")
    shutil.rmtree(copied.path / other / "S002")
    assert verify(copied.path, replays=False).sound


def test_a_folder_with_a_wrong_name_is_no_data_until_it_has_its_own(
    study: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    ppid = study.participants()[0].ppid
    (study.path / ppid).rename(study.path / "lost and found")
    assert main(["study", "tables", str(study.path)]) == 0
    assert (
        f"lost and found holds the data of {ppid}: rename it to {ppid}" in capsys.readouterr().out
    )
    assert len(rows_of(study.path / "tables/participants.csv")) == 1
