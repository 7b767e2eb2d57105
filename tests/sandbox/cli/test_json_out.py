"""Trying whether a result can be written leaves everything as it was."""

from __future__ import annotations

from pathlib import Path

import pytest

from models.errors import InputError
from sandbox.cli.common.json_out import check_output


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
