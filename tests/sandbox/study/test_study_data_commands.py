"""`sandbox study export`, `withdraw`, `backup` and `merge`, as somebody types them."""

from __future__ import annotations

import csv
import io
import json
import shutil
from hashlib import blake2b
from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.run.simulate import simulate, simulated_person
from tests.support.study_files import DESIGN, TRIALS, design


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("made")
    simulate(StudyFolder(out, design(), SIMULATED), 2, False, lambda text: None)
    return out / "quick-simulated"


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    shutil.copytree(made, tmp_path / "kept/quick-simulated")
    return tmp_path / "kept/quick-simulated"


def people_of(folder: Path) -> list[str]:
    rows = csv.DictReader((folder / "participants.csv").open(encoding="utf-8"))
    return [row["ppid"] for row in rows]


def test_a_backup_an_export_and_a_withdrawal_follow_each_other(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    archive, shared = tmp_path / "b.tar.gz", tmp_path / "shared"
    assert main(["study", "backup", str(folder), "--out", str(archive)]) == 0
    assert main(["study", "backup", "--check", str(archive)]) == 0
    assert capsys.readouterr().out.count(f"2 participants, {2 * TRIALS} finished trials") == 2
    assert (
        main(
            ["study", "export", str(folder), "--anonymise", "--bin", "age:10", "--out", str(shared)]
        )
        == 0
    )
    assert "k = 1: 2 people share their" in capsys.readouterr().out
    about = json.loads((shared / "anonymised.json").read_text())
    assert (
        about["rounded_down_to"] == {"age": 10.0, "hand_size": 0.1}
        and about["people_in_groups_below_5"] == 2
    )
    gone, stays = people_of(folder)
    assert main(["study", "withdraw", str(folder), "--participant", gone.lower(), "--yes"]) == 0
    said = capsys.readouterr().out
    assert "files deleted" in said and str(archive) in said and str(shared) in said
    assert people_of(folder) == [stays] and not (folder / gone).exists()


@pytest.mark.parametrize(
    ("people", "sizes", "told"),
    [
        (1, (1.0,), "k = 1: the copy has fewer than 5 people"),
        (4, (1.0,) * 4, "k = 4: the copy has fewer than 5 people"),
        (5, (1.0,) * 5, "k = 5: everybody shares hand, language and demographic answers with 4"),
        (6, (1.0,) * 5 + (0.8,), "k = 1: 1 person shares their hand_size with fewer than 4 others"),
    ],
)
def test_an_export_always_tells_the_size_of_the_smallest_group(
    tmp_path: Path,
    people: int,
    sizes: tuple[float, ...],
    told: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = DESIGN[: DESIGN.index("[[demographics]]")]
    text = text.replace("repetitions = 2", "repetitions = 1").replace(', "soft"', "")
    study = StudyFolder(tmp_path, design(text), SIMULATED)
    for number, size in enumerate(sizes):
        about = {**simulated_person(study.design, number), "hand": "right", "hand_size": size}
        study.add(number, **about)
    simulate(study, people, True, lambda said: None)
    out = tmp_path / "shared"
    assert main(["study", "export", str(study.path), "--anonymise", "--out", str(out)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert told in said and f"{people} participant" in said
    assert "1 participants" not in said


def test_a_report_counts_who_withdrew_and_so_does_that_of_an_anonymous_copy(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shared = tmp_path / "shared"
    assert main(["study", "report", str(folder)]) == 0
    page = folder / "report" / "report.html"
    assert "Nobody withdrew." in page.read_text() and "withdrew" not in capsys.readouterr().out
    gone = people_of(folder)[0]
    assert main(["study", "withdraw", str(folder), "--participant", gone, "--yes"]) == 0
    assert main(["study", "export", str(folder), "--anonymise", "--out", str(shared)]) == 0
    assert gone not in "".join(p.read_text() for p in shared.glob("*.json*"))
    for copy in (folder, shared):
        capsys.readouterr()
        assert main(["study", "report", str(copy)]) == 0
        told = "1 person withdrew. All their data were deleted"
        assert told in capsys.readouterr().out
        text = (copy / "report" / "report.html").read_text()
        assert told in text and "of 1 who began; 1 more withdrew" in text and gone not in text
        first = next(csv.DictReader((copy / "report" / "exclusions.csv").open()))
        assert (first["step"], first["participants"]) == ("withdrew, in no other number", "1")
    assert main(["replay", str(shared), "--verify"]) == 0


def test_an_unknown_participant_cannot_be_withdrawn_and_is_not_called_new(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for wrong in ("ZZZZZZ", "000000", "new"):
        assert main(["study", "withdraw", str(folder), "--participant", wrong, "--yes"]) == 2
        said = capsys.readouterr().err
        assert "no such participant in this study" in said and "--participant new" not in said
        assert ", ".join(people_of(folder)) in said and "expected new" not in said


def test_without_a_yes_nothing_is_deleted(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for answer in ("no", ""):
        monkeypatch.setattr("builtins.input", lambda said=answer: said)
        ppid = people_of(folder)[0]
        assert main(["study", "withdraw", str(folder), "--participant", ppid]) == 1
        assert "cannot be undone" in capsys.readouterr().out and (folder / ppid).exists()


def test_where_nobody_can_answer_a_withdrawal_is_refused_with_a_way_out(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ppid = people_of(folder)[0]
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert main(["study", "withdraw", str(folder), "--participant", ppid]) == 2
    assert "--yes deletes without asking" in capsys.readouterr().err and (folder / ppid).exists()


def test_a_bids_data_set_of_an_anonymous_copy_has_new_names(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "bids"
    assert main(["study", "export", str(folder), "--anonymise", "--bids", "--out", str(out)]) == 0
    subjects = {p.name.removeprefix("sub-") for p in out.glob("sub-*")}
    assert len(subjects) == 2 and not subjects & set(people_of(folder))
    assert main(["study", "export", str(folder), "--bids", "--out", str(tmp_path / "own")]) == 0
    subjects = {p.name.removeprefix("sub-") for p in (tmp_path / "own").glob("sub-*")}
    assert subjects == set(people_of(folder))


def test_two_folders_are_merged_by_a_command(
    folder: Path, made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "both/quick-simulated"
    assert main(["study", "merge", str(folder), str(made), "--out", str(out)]) == 0
    assert "2 participants" in capsys.readouterr().out
    gone = sorted(people_of(out))[0]
    assert sorted(people_of(out)) == sorted(people_of(made))
    # The folders that were merged still hold who withdraws from the merged one.
    assert main(["study", "withdraw", str(out), "--participant", gone, "--yes"]) == 0
    said = capsys.readouterr().out
    assert str(folder) in said and str(made) in said


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["export", "{}", "--out", "x"], "the kind of copy is missing"),
        (["export", "{}", "--anonymise", "--out", "{}/inside"], "inside its source"),
        (["export", "{}", "--anonymise", "--bin", "age", "--out", "x"], "not an item and width"),
        (["export", "{}", "--anonymise", "--bin", "age:inf", "--out", "x"], "from 1e-06 to 1e+06"),
        (["export", "{}", "--anonymise", "--bin", "age:1e-300", "--out", "x"], "from 1e-06 to"),
        (
            ["export", "{}", "--anonymise", "--drop", "wage", "--out", "x"],
            "no such demographic item",
        ),
        (["export", "{}", "--bids", "--drop", "age", "--out", "x"], "are for --anonymise"),
        (["export", "{}/..", "--bids", "--out", "x"], "not a study folder"),
        (["backup", "{}"], "a study and an archive are needed"),
        (["backup", "--check", "{}/design.toml"], "the backup is damaged"),
        (["backup", "--check", "{}/nowhere"], "the backup is damaged"),
        (["withdraw", "{}", "--participant", "ABCDEF"], "no such participant in this study"),
        (["withdraw", "{}", "--participant", "ZZZZZZ"], "of participants.csv there lists all"),
        (["merge", "{}", "{}", "--out", "x"], "the same folder"),
    ],
)
def test_a_mistake_costs_one_line_and_nothing_else(
    folder: Path,
    words: list[str],
    what: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    assert main(["study", *(word.format(folder) for word in words)]) == 2
    said = capsys.readouterr().err
    assert what in said and "Traceback" not in said
    assert {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()} == before
    assert not (tmp_path / "x").exists()


def test_consent_is_kept_with_version_language_and_a_digest_of_what_was_read(made: Path) -> None:
    for ppid in people_of(made):
        records = read_journal(made / ppid / "S001/journal.jsonl")
        (consent,) = [r for r in records if r["kind"] == "consent"]
        assert "Do you agree?" in DESIGN
        wanted = blake2b(b"Do you agree?", digest_size=16).hexdigest()
        assert consent["agreed"] is True and consent["text"] == wanted
        assert (consent["version"], consent["language"]) == ("1", "en")
