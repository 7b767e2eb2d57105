"""Cost of a study's tables per trial and per session, at 1, 10 and 100 participants.

python -m benchmarks.study_tables [--people 1 10 100] [--trials 15]

Journals are synthetic: trials are not played, and their recordings are empty. What is timed is what
`SessionRunner` does about tables after a trial, and at the beginning and the end of a session.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

from benchmarks.machine import describe_machine
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import load_design
from sandbox.study.design.plan import TrialStep, trials_of
from sandbox.study.measures.compute import VERSION
from sandbox.study.measures.registry import measures
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.simulate import simulated_person
from sandbox.study.tables.tables import StudyTables, rebuild_session
from sandbox.trial.result import KeptIn, TrialResult
from tasks.score import Status

DESIGN = Path(__file__).resolve().parent.parent / "examples" / "study" / "design.toml"
PEOPLE = (1, 10, 100)
SESSIONS = 5
"""Updates at the end of a session that are timed."""


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--people", type=int, nargs="+", default=PEOPLE, help="participants")
    parser.add_argument("--trials", type=int, default=15, help="timed trials of the last one")
    options = parser.parse_args()
    design = load_design(DESIGN)
    print(f"{describe_machine()}\n")
    print("Medians, in ms; fsync included.\n")
    print(
        "| participants | trials a session | after a trial | session begins | session ends "
        "| all, per trial |"
    )
    print("| --- | --- | --- | --- | --- | --- |")
    for people in options.people:
        with tempfile.TemporaryDirectory() as folder:
            row = costs(Path(folder), design, people, options.trials)
        print("| " + " | ".join(row) + " |", flush=True)


def costs(folder: Path, design: Design, people: int, timed: int) -> list[str]:
    """A row of the table.

    Args:
        folder: An empty one.
        design: Design of the study.
        people: Participants; all but the last have finished.
        timed: Trials of the last one that are timed.
    """
    study = StudyFolder(folder, design, SIMULATED)
    for number in range(people):
        person = study.add(**simulated_person(design, number))
        with SessionFolder(study, person) as session:
            steps = trials_of(session.steps)
            played = steps[: len(steps) - timed - 1] if number == people - 1 else steps
            for step in played:
                play(session, step)
    tables = StudyTables(study)
    begins = milliseconds(tables.update)
    after = []
    with SessionFolder(study, person) as session:
        for step in steps[len(played) : len(played) + timed]:
            play(session, step)
            after.append(milliseconds(lambda: rebuild_session(session)))
        # As after a session of many minutes: nobody else's files have changed just now.
        time.sleep(1.5)
        tables.update()
        ends = []
        for _ in range(SESSIONS):
            session.write("note", text="another line", trial=None)
            ends.append(milliseconds(tables.update))
    whole = median(after) + (begins + median(ends)) / len(steps)
    numbers = [median(after), begins, median(ends), whole]
    return [str(people), str(len(steps)), *(f"{x:.1f}" for x in numbers)]


def play(session: SessionFolder, step: TrialStep) -> None:
    """Writes what a finished trial leaves: journal records, a recording, and measures."""
    result = TrialResult(
        task="box-to-goal",
        encoder="best",
        seed=step.seed,
        success=True,
        instant=True,
        held=True,
        final=True,
        status=Status.HELD,
        progress=1.0,
        time_s=4.56,
        reason="",
        state_hash="0" * 32,
        measures={"first_contact_s": 0.3, "lost_s": 0.0},
    )
    recording = session.begin(step)
    recording.touch()
    values = {m.name: 0.123456 for m in measures() if m.of_trial is not None}
    text = json.dumps({"version": VERSION, "truth": "", **values, "reasons": {}})
    (session.path / "trackers" / f"measures_{recording.stem}.json").write_text(text)
    session.write(
        "trial_end",
        step=step.id,
        trial=step.number,
        attempt=1,
        file=f"trials/{recording.name}",
        result=result.kept_in(KeptIn.JOURNAL),
    )


def milliseconds(work: Callable[[], object]) -> float:
    """Time that a call takes, by the clock."""
    began = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - began)


if __name__ == "__main__":
    main()
