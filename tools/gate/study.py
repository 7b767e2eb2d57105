"""A study of two simulated people that is killed and resumed.

    python -m tools.gate.study OUT PEOPLE LINES    # one run, which kills itself

Only `run_until_killed` and `rows_of` depend on how a study is simulated, where a session's record
is, and which columns the tables have.
"""

from __future__ import annotations

import csv
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from sandbox.cli.main import main
from sandbox.study.record.journal import Journal, read_journal
from tools.gate.rows import DIGITS, Observed

DESIGN = Path(__file__).with_name("study.toml")
PEOPLE = 2
KILLS = (3, 5, 31, 40, 50, 58)
"""Numbers of lines of a session's record at which the program is killed. The third is at the first
form after trials."""


def run_until_killed(out: Path, people: int, lines: int) -> int:
    """Begins or resumes the study, and kills this process once a session's record has `lines`
    lines.

    Args:
        out: Folder of the study.
        people: Number of people who take part.
        lines: Number of lines of the record; 0 does not kill the process.
    """
    write: Callable[..., object] = Journal._write

    def counted(journal: Journal, line: bytes) -> None:
        write(journal, line)
        # The record that was just written is not in the list yet.
        in_session = journal.path.parent.parent.parent == out.resolve() / "gate-simulated"
        if in_session and len(journal.records) + 1 == lines:
            os.kill(os.getpid(), signal.SIGKILL)

    Journal._write = counted  # type: ignore[method-assign,assignment]
    options = ["--out", str(out.resolve()), "--participants", str(people), "--resume"]
    return main(["study", "simulate", str(DESIGN), *options])


def rows_of(out: Path) -> dict[str, Observed]:
    """Rows of a finished study: trials that count, and answers."""
    study = out / "gate-simulated"
    rows: dict[str, Observed] = {}
    people: dict[str, str] = {}
    for trial in csv.DictReader((study / "tables/trials.csv").open(encoding="utf-8")):
        # The names of rows count from 0, as tables did in earlier versions.
        people[trial["participant"]] = str(int(trial["number"]) - 1)
        if trial["counted"] == "1":
            name = f"person {people[trial['participant']]}, trial {trial['trial']}"
            rows[name] = {
                "levels": f"{trial['factor_solid']} {trial['factor_task']}",
                "practice": trial["practice"] == "1",
                "seed": int(trial["seed"]),
                "hash": trial["state_hash"][:DIGITS],
                "success": trial["success"] == "1",
            }
    for answer in csv.DictReader((study / "tables/answers.csv").open(encoding="utf-8")):
        person = people[answer["participant"]]
        name = f"person {person}, {answer['instrument']} {answer['block']}, {answer['item']}"
        rows[name] = {"answer": answer["answer"]}
    for ppid, person in people.items():
        records = read_journal(study / ppid / "S001" / "session.jsonl")
        # If the answers of a form were lost, the form was shown again.
        forms = sum(record["kind"] == "form" for record in records)
        rows[f"person {person}, forms"] = {"answered": forms}
    return rows


def play() -> dict[str, Observed]:
    """Plays the study, which is killed six times for each person, and returns its rows."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        for person in range(1, PEOPLE + 1):
            for lines in (*KILLS, 0):
                command = [sys.executable, "-m", "tools.gate.study"]
                run = subprocess.run(
                    [*command, str(out), str(person), str(lines)],
                    capture_output=True,
                    text=True,
                    check=False,
                )
                expected = -signal.SIGKILL if lines else 0
                if run.returncode != expected:
                    return {
                        f"person {person}, killed at line {lines}": {
                            "exit": run.returncode,
                            "error": run.stderr[-400:],
                        }
                    }
        return rows_of(out)


if __name__ == "__main__":
    sys.exit(run_until_killed(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])))
