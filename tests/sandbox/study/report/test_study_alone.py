"""A report needs tables and nothing else, so that it can be made where nothing else is."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tests.sandbox.study.report.study_reports import planted, report

SCRIPT = """
import json, sys
from pathlib import Path
from sandbox.study.report.make import make_report
make_report(Path(sys.argv[1]), Path(sys.argv[1]) / "report")
print(json.dumps([name for name in sys.modules if name.startswith("sandbox.study")]))
"""


def test_a_report_loads_of_the_study_room_the_names_of_columns_alone(tmp_path: Path) -> None:
    planted(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(tmp_path)], capture_output=True, text=True, check=True
    )
    loaded = json.loads(done.stdout)
    others = [name for name in loaded if not name.startswith("sandbox.study.report")]
    assert set(others) <= {"sandbox.study", "sandbox.study.tables", "sandbox.study.tables.column"}


def test_tables_without_records_are_named_in_the_first_line_of_their_report(tmp_path: Path) -> None:
    planted(tmp_path)
    alone = "There are no records in this folder"
    assert f"planted-1, simulated {alone}" in report(tmp_path).text
    (tmp_path / "3B5G5T/S001").mkdir(parents=True)
    (tmp_path / "3B5G5T/S001/session.jsonl").write_text("")
    assert alone not in report(tmp_path).text
