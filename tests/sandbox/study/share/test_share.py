"""An anonymous copy tells nothing that could say who somebody was, and still replays and counts."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import StudyError
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.simulated_study import run_simulated, simulate
from sandbox.study.share.masking import WITHHELD, binned, groups, without_folders
from sandbox.study.share.shared_folder import Masking, Shared, share_study
from sandbox.study.tables.tables import make_tables
from tests.support.study_files import DESIGN, TRIALS, design, quiet, rows_of

SECRET = "Anna Kowalczyk in room 412"


TEXT = DESIGN.replace(
    "[[questionnaires]]",
    '[[demographics]]\nname = "remarks"\nkind = "text"\nask = "Remarks?"\noptional = true\n'
    "[[questionnaires]]",
)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """A study of two people, of whom the experimenter has written who they are."""
    found = StudyFolder(tmp_path_factory.mktemp("kept"), design(TEXT), SIMULATED)
    simulate(found, 2, False, quiet)
    for person in found.participants():
        with SessionFolder(found, person) as session:
            session.command("exclude", trial=2, reason=SECRET)
            session.write(
                "form",
                step="form:demographics",
                form="demographics",
                block=0,
                levels={},
                answers={"age": 37, "remarks": SECRET},
            )
    make_tables(found)
    return found


@pytest.fixture(scope="module")
def copy(study: StudyFolder, tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    out = tmp_path_factory.mktemp("shared") / "quick-simulated"
    found = share_study(study, out, Masking(bins={"age": 10}, hands=True), quiet)
    assert isinstance(found, Shared) and found.people == 2
    return StudyFolder.at(out)


def contents(folder: Path) -> dict[str, bytes]:
    """All files, unpacked where they are packed."""
    return {
        str(p.relative_to(folder)): gzip.decompress(p.read_bytes())
        if p.suffix == ".gz"
        else p.read_bytes()
        for p in folder.rglob("*")
        if p.is_file()
    }


def test_results_are_the_same_but_for_names_and_dates(
    study: StudyFolder, copy: StudyFolder
) -> None:
    def results(folder: StudyFolder) -> list[dict[str, str]]:
        rows = rows_of(folder.path / "tables/trials.csv")
        files = ("participant", "recording", "frames", "exclusion_reason")
        rows.sort(key=lambda r: (int(r["number"]), int(r["trial"])))
        return [{k: v for k, v in r.items() if k not in (*files, "hand_size")} for r in rows]

    assert results(study) == results(copy) and len(results(copy)) == 2 * TRIALS
    excluded = [r for r in rows_of(copy.path / "tables/trials.csv") if r["excluded"] == "1"]
    assert [r["trial"] for r in excluded] == ["2", "2"]
    assert {r["exclusion_reason"] for r in excluded} == {WITHHELD}


def test_numbers_are_rounded_and_words_are_gone_unless_asked_for(
    study: StudyFolder, copy: StudyFolder, tmp_path: Path
) -> None:
    people = rows_of(copy.path / "tables/participants.csv")
    assert [p["age"] for p in people] == ["30"] * 2 and "remarks" not in people[0]
    share_study(study, tmp_path / "more", Masking(words=True, drop=("age",)), quiet)
    people = rows_of(tmp_path / "more/tables/participants.csv")
    assert [p["remarks"] for p in people] == [SECRET] * 2 and "age" not in people[0]


def test_who_did_not_agree_is_not_in_the_copy(tmp_path: Path) -> None:
    found = StudyFolder(tmp_path / "kept", design(), SIMULATED)
    run_simulated(found, 1, quiet)
    with SessionFolder(found, found.add(hand="left")) as session:
        session.write("consent", step="consent", agreed=False, version="1", language="en")
    done = share_study(found, tmp_path / "open", Masking(), quiet)
    assert (done.people, done.without_consent) == (1, 1)
    assert "left" not in {p.hand for p in StudyFolder.at(tmp_path / "open").participants()}


def test_a_copy_is_never_written_over_anything(study: StudyFolder, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    with pytest.raises(StudyError, match="exists already"):
        share_study(study, tmp_path / "there", Masking(), quiet)
    with pytest.raises(StudyError, match="no such demographic item"):
        share_study(study, tmp_path / "other", Masking(drop=("income",)), quiet)
    assert list(tmp_path.iterdir()) == [tmp_path / "there"]


def test_the_size_of_a_hand_is_coarse_and_recordings_that_tell_it_are_left_out(
    study: StudyFolder, tmp_path: Path
) -> None:
    sizes = {p.hand_size for p in study.participants()}
    done = share_study(study, tmp_path / "coarse", Masking(), quiet)
    assert done.hands == 2 * TRIALS and not list((tmp_path / "coarse").rglob("T0*.jsonl*"))
    for row in rows_of(tmp_path / "coarse/tables/participants.csv"):
        assert float(row["hand_size"]) in {binned(size, 0.1) for size in sizes}
    for data in contents(tmp_path / "coarse").values():
        assert not [size for size in sizes if str(size).encode() in data]
    share_study(study, tmp_path / "kept", Masking(hands=True), quiet)
    about = json.loads((tmp_path / "kept/anonymised.json").read_bytes())
    assert "hand_size" in about["compared"] and about["smallest_group"] == 1
    share_study(study, tmp_path / "one", Masking(bins={"hand_size": 5.0}, drop=("age",)), quiet)
    about = json.loads((tmp_path / "one/anonymised.json").read_bytes())
    assert "hand_size" not in about["compared"]
    with pytest.raises(StudyError, match="no such demographic item"):
        share_study(study, tmp_path / "none", Masking(drop=("hand_size",)), quiet)


@pytest.mark.parametrize(
    "path", ["/home/anna/design.py", "~/anna/design.py", "C:\\anna\\design.py", "../anna/design.py"]
)
def test_names_of_folders_are_gone_and_names_of_files_stay(path: str) -> None:
    assert without_folders({"a": [path, 3, "one/two"]}) == {"a": ["design.py", 3, "one/two"]}


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 2)), min_size=1, max_size=30))
def test_the_smallest_group_is_found_by_comparing_everybody_with_everybody(
    people: list[tuple[int, int]],
) -> None:
    found = groups([{"a": a, "b": b} for a, b in people], ("a", "b"))
    assert found.smallest == min(people.count(p) for p in people)
    assert found.exposed == sum(people.count(p) < 5 for p in people)


@given(st.integers(-1000, 1000), st.sampled_from([1, 5, 10]))
def test_a_rounded_number_is_the_low_end_of_its_bin(value: int, width: int) -> None:
    assert binned(value, width) % width == 0 and 0 <= value - binned(value, width) < width
