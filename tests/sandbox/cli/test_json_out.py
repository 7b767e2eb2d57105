"""Trying whether a result can be written leaves everything as it was."""

from __future__ import annotations

from pathlib import Path

import pytest

from models.errors import InputError
from sandbox.cli.common.json_out import check_output, refuse_same
from sandbox.cli.main import main


def test_trying_a_file_leaves_files_and_links_as_they_were(tmp_path: Path) -> None:
    new, old, link = tmp_path / "new.json", tmp_path / "old.json", tmp_path / "link.json"
    old.write_text("kept")
    link.symlink_to(tmp_path / "later.json")
    for path in (new, old, link, Path("-"), None):
        check_output(path)
    assert not new.exists() and old.read_text() == "kept"
    assert link.is_symlink() and not link.exists()
    assert sorted(tmp_path.iterdir()) == [link, old]


@pytest.mark.parametrize("name", ["none/out.json", "", "x" * 300])
def test_what_cannot_be_written_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="--json"):
        check_output(tmp_path / name)


def test_two_results_in_one_file_are_refused(tmp_path: Path) -> None:
    one, link = tmp_path / "one.json", tmp_path / "link.json"
    link.symlink_to(one)
    refuse_same({"--json": one, "--record": None, "--film": Path("-"), "--events": Path("-")})
    for other in (one, link, tmp_path / "x" / ".." / "one.json"):
        with pytest.raises(InputError, match=r"--record .*two results would be in one file"):
            refuse_same({"--json": one, "--record": other})


@pytest.mark.parametrize(
    "command",
    [
        "run box-to-goal --record one.jsonl --json one.jsonl",
        "run box-to-goal --film one.webp --motion one.webp",
        "regress --tasks box-to-goal --baseline kept.json --json kept.json",
        "evaluate --paalm . --json kept.json",
        "devices leap simulate --capture kept.json --out kept.json",
        "paalm calibrate kept.json --hands right --out kept.json",
        "devices robot fit kept.json --tips a,b,c --out kept.json",
    ],
)
def test_no_command_replaces_what_it_reads_or_another_of_its_results(
    command: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("kept.json").write_text("{}")
    assert main(command.split()) == 2
    assert "in one file" in (said := capsys.readouterr().err) or "would replace" in said
    assert Path("kept.json").read_text() == "{}" and not Path("one.jsonl").exists()
