"""What was removed is refused by name, with what takes its place."""

from __future__ import annotations

import pytest

from models.errors import InputError
from sandbox.cli import removed
from sandbox.cli.main import main
from sandbox.cli.removed import REMOVED, refuse_removed


@pytest.mark.parametrize("old", REMOVED)
def test_every_entry_is_refused_in_one_line(old: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(old.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert old in line and REMOVED[old] in line


def test_words_match_exactly_and_options_stand_anywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    table = {"study plan --pilot": "a", "study preregister": "b", "train --encoder mean": "c"}
    table |= {"--without history": "d", "--tell-labels": "e"}
    monkeypatch.setattr(removed, "REMOVED", table)
    for line in (
        "study plan design.toml --pilot 12",
        "study plan --pilot=12",
        "study preregister design.toml",
        "train --out x.npz --encoder=mean",
        "run stack --without stitch history --seed 3",
        "regress --tell-labels",
    ):
        with pytest.raises(InputError, match="was removed"):
            refuse_removed(line.split())
    for line in ("study plan --pilots", "study run preregister", "train --encoder meaner", "train"):
        refuse_removed(line.split())
