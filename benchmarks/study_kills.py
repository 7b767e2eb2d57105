"""Kills sessions of a study at random moments, resumes them, and compares with an undisturbed one.

Every session is of a simulated participant: consent, questions, trials and a questionnaire after
each level. The times of the kills are uniform over the duration of such a session, from its first
folder to its last table. Prints how many sessions were killed, and in how many of these

- every trial and every answer that was on the disk at the kill is in the record at the end;
- the tables of the resumed study are equal to those of an undisturbed session, except for times,
  pseudonyms and numbers of attempts;
- the checks of `sandbox replay STUDY --verify` find no problem. States are not compared, since that
  takes longer.

    python -m benchmarks.study_kills --kills 200
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.machine import describe_machine
from sandbox.study.record.copies import JOURNAL
from sandbox.study.record.journal import read_journal
from tests.support.study_driver import results, resume, run, verify
from tests.support.study_files import DESIGN, TRIALS, in_child, killed_after

LONGEST = 600.0
"""Time (s) after which an undisturbed session is ended."""


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=200, help="number of sessions to kill")
    parser.add_argument("--seed", type=int, default=1, help="seed of the times of the kills")
    options = parser.parse_args()
    rng, found, trials = np.random.default_rng(options.seed), Counter[str](), []
    with TemporaryDirectory() as folder:
        undisturbed, lasted = whole(Path(folder))
        while found["killed"] < options.kills:
            moment = float(rng.uniform(0.0, lasted))
            with TemporaryDirectory() as out:
                done = killed_once(Path(out), moment, undisturbed)
            if done is not None:
                found.update(killed=1, **done)
                trials.append(done["trials"])
                print(f"{found['killed']}: after {moment:.2f} s, {done}", flush=True)
    print(describe_machine())
    print(f"an undisturbed session takes {lasted:.2f} s; it has {TRIALS} trials")
    print(f"killed {found['killed']}, with {np.bincount(trials)} of 0, 1, ... finished trials")
    print(f"nothing finished is lost: {found['kept']}")
    print(f"tables equal: {found['same']}")
    print(f"nothing found by the checks: {found['sound']}")


def whole(out: Path) -> tuple[dict[str, Any], float]:
    """Runs an undisturbed session. Returns its tables and its duration (s)."""
    began = time.monotonic()
    killed, said = killed_after(in_child(lambda say: run(out, DESIGN)), LONGEST)
    assert not killed, said
    return results(next(out.iterdir())), time.monotonic() - began


def killed_once(out: Path, moment: float, undisturbed: dict[str, Any]) -> dict[str, int] | None:
    """Kills a session after `moment` s and resumes it. Returns the counts of its result, or None if
    the session had ended before."""
    killed, _ = killed_after(in_child(lambda say: run(out, DESIGN)), moment)
    if not killed:
        return None
    before = finished(out)
    folder = resume(out / "quick-simulated", DESIGN)
    return {
        "trials": sum(kind == "trial_end" for kind, *_ in before),
        "kept": before <= finished(out),
        "same": results(folder) == undisturbed,
        "sound": not verify(folder),
    }


def finished(out: Path) -> set[tuple[str, ...]]:
    """Returns the finished trials and answers in the record of a session."""
    return {
        (record["kind"], record["step"], str(record.get("item")), str(record.get("result")))
        for path in out.glob(f"*/*/S001/{JOURNAL}")
        for record in read_journal(path)
        if record["kind"] in ("consent", "answer", "form") or record.get("result")
    }


if __name__ == "__main__":
    main()
