"""A report says where a simulated user, and no person, played a pilot's trials."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.study.report.data import load_study
from tests.sandbox.study.report.study_reports import planted, put


def test_a_rehearsal_that_a_simulated_user_played_is_never_taken_for_people(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # As `study run --pilot --device simulated` writes it: data of a pilot.
    rows = [{**row, "mode": "pilot"} for row in planted(tmp_path)]
    nobody = "No person took part: a simulated user played all trials."
    for name, source, telling in (
        ("played", "simulated user", nobody),
        ("some", "", "A simulated user, and no person, played 1 of"),
        ("device", "device", ""),
    ):
        told = [{**row, "label_truth": source} for row in rows]
        if name == "some":
            counted = [row for row in told if row["counted"] == "1" and row["practice"] == "0"]
            counted[0]["label_truth"] = "simulated user"
            counted[1]["label_truth"] = "device"
        folder = tmp_path / name
        put(folder, told, tuple(told[0]))
        data = load_study(folder)
        assert data.rehearsed.startswith(telling) and bool(data.rehearsed) == bool(telling), name
        assert main(["study", "report", str(folder)]) == 0
        said = " ".join(capsys.readouterr().out.split())
        page = (folder / "report" / "report.html").read_text(encoding="utf-8")
        assert (data.rehearsed in said) and (data.rehearsed in page)
