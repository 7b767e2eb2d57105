"""Tampers with finished studies, kills running ones, and counts what `replay --verify` says.

A study of two simulated participants with quick trials is tampered with, from one bit to one whole
file; a tampering is found if a line of the verification names the file. Of every tenth one the exit
status of the command is tried, too. Forgeries compute every digest, seal and table anew; they are
judged by the command, without and with a witness. Kills are SIGKILL at random moments of a
simulated study, which is then resumed. Right after every kill, verification without replays must
find nothing; the command must end with 0 when the study has been resumed to its end.

    python -m benchmarks.audit --tamperings 200 --forgeries 20 --kills 200 --seed 18
"""

from __future__ import annotations

import argparse
import contextlib
import io
import random
import re
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.machine import describe_machine
from sandbox.cli.main import main as sandbox
from sandbox.study.audit.audit import audit
from sandbox.study.record.chain import Record
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import journal_bytes, read_journal
from sandbox.study.run.simulate import simulate
from sandbox.study.tables.tables import rebuild_all
from tests.support.study_files import (
    TRIALS,
    check_session,
    design,
    in_child,
    killed_after,
    open_study,
    told_finished,
)

BROKEN_OFF = re.compile(r"(\d+) attempts that were broken off")
WHOLE = 300.0
"""s after which a run that nobody kills is given up."""


def main() -> None:
    """Prints all tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tamperings", type=int, default=200)
    parser.add_argument("--forgeries", type=int, default=20)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=18)
    options = parser.parse_args()
    print(f"{describe_machine()}; seed {options.seed}\n")
    with tempfile.TemporaryDirectory(prefix="hand-sandbox-audit-") as name:
        work = Path(name)
        witness = work / "witness.jsonl"
        simulate(StudyFolder(work, design(), SIMULATED), 2, False, lambda text: None, witness)
        study = work / "quick-simulated"
        status, said = verify(study, witness)
        assert status == 0, said
        if options.tamperings:
            tamper_often(study, options.tamperings, random.Random(options.seed))
        if options.forgeries:
            forge_often(study, witness, options.forgeries, random.Random(options.seed + 1))
        if options.kills:
            kill_often(work / "killed", options.kills, random.Random(options.seed + 2))


def verify(study: Path, witness: Path | None = None) -> tuple[int, str]:
    """Exit status and output of `sandbox replay STUDY --verify`."""
    words = ["replay", str(study), "--verify"]
    words += ["--witness", str(witness)] if witness else []
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        status = sandbox(words)
    return status, out.getvalue()


def tamper_often(study: Path, count: int, chance: random.Random) -> None:
    """Tampers with one file after another, and prints how often that was found."""
    done: Counter[str] = Counter()
    found: Counter[str] = Counter()
    tried = ended_with_1 = 0
    while done.total() < count:
        kind = chance.choice(list(TAMPERINGS))
        files = sorted(p for p in study.rglob("*") if p.is_file() and p.name != ".lock")
        path = chance.choice(files)
        before = path.read_bytes()
        named = TAMPERINGS[kind](path, before, chance)
        if named is None:
            continue
        name = named.relative_to(study).as_posix()
        found[kind] += any(finding.path == name for finding in audit(study).findings.found)
        if done.total() % 10 == 0:
            tried += 1
            ended_with_1 += verify(study)[0] == 1
        done[kind] += 1
        if named != path:
            named.unlink()
        path.write_bytes(before)
    print("| tampering | done | found, and the file named |\n| --- | --- | --- |")
    for kind in TAMPERINGS:
        print(f"| {kind} | {done[kind]} | {found[kind]} |")
    print(f"| all | {done.total()} | {found.total()} |\n")
    print(f"Exit status 1 in {ended_with_1} of the {tried} that were tried.\n")
    status, said = verify(study)
    assert status == 0, said


Tampering = Callable[[Path, bytes, random.Random], Path | None]
"""Changes a file; returns the file that must be named, or None if it could not be changed so."""


def _put(path: Path, before: bytes, after: bytes) -> Path | None:
    if after == before:
        return None
    path.write_bytes(after)
    return path


def one_bit(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """One bit is another one."""
    changed = bytearray(data)
    changed[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    return _put(path, data, bytes(changed))


def some_bytes(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """Up to 64 bytes are overwritten."""
    start, length = chance.randrange(len(data)), chance.randrange(1, 65)
    other = chance.randbytes(min(length, len(data) - start))
    return _put(path, data, data[:start] + other + data[start + len(other) :])


def cut(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """The end is cut off."""
    return _put(path, data, data[: chance.randrange(len(data))])


def no_line(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """A line is deleted."""
    lines = _lines(path, data)
    if lines:
        del lines[chance.randrange(len(lines))]
    return _put(path, data, b"".join(lines)) if lines else None


def swapped_lines(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """Two lines change places."""
    lines = _lines(path, data)
    if len(lines) < 2:
        return None
    a, b = chance.sample(range(len(lines)), 2)
    lines[a], lines[b] = lines[b], lines[a]
    return _put(path, data, b"".join(lines))


def doubled_line(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """A line is written twice."""
    lines = _lines(path, data)
    if not lines:
        return None
    at = chance.randrange(len(lines))
    return _put(path, data, b"".join([*lines[: at + 1], *lines[at:]]))


def another_digit(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """A digit in a text is another digit."""
    places = [i for i, byte in enumerate(data) if 48 <= byte < 58] if _lines(path, data) else []
    if not places:
        return None
    at = chance.choice(places)
    return _put(path, data, data[:at] + str(chance.randrange(10)).encode() + data[at + 1 :])


def no_file(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """The file is deleted."""
    path.unlink()
    return path


def another_file(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """The file is that of another trial or participant."""
    study = next(p for p in path.parents if (p / "design.toml").exists())
    kin = [p for p in sorted(study.rglob(f"*{path.suffix}")) if p.parent.name == path.parent.name]
    return _put(path, data, chance.choice(kin).read_bytes())


def one_more_file(path: Path, data: bytes, chance: random.Random) -> Path | None:
    """A file of a trial is there twice."""
    if path.parent.name not in ("trials", "trackers"):
        return None
    copy = path.with_name(path.name.replace("_T0", "_T1") if "_" in path.name else f"T1{path.name}")
    copy.write_bytes(data)
    return copy


def _lines(path: Path, data: bytes) -> list[bytes]:
    """Lines of a text; none of other files."""
    return [] if path.suffix in (".gz", ".parquet") else data.splitlines(keepends=True)


TAMPERINGS: dict[str, Tampering] = {
    "one bit": one_bit,
    "up to 64 bytes overwritten": some_bytes,
    "the end cut off": cut,
    "a line deleted": no_line,
    "two lines swapped": swapped_lines,
    "a line doubled": doubled_line,
    "another digit in a text": another_digit,
    "a file deleted": no_file,
    "a file replaced by another of its kind": another_file,
    "a file of a trial added": one_more_file,
}


def forge_often(study: Path, witness: Path, count: int, chance: random.Random) -> None:
    """Forges studies with all digests anew; prints how often that passes, and who finds it."""
    done: Counter[str] = Counter()
    passed: Counter[str] = Counter()
    found: Counter[str] = Counter()
    for number in range(count):
        kind = list(FORGERIES)[number % len(FORGERIES)]
        forged = study.with_name("forged") / study.name
        shutil.copytree(study, forged)
        FORGERIES[kind](forged, chance)
        done[kind] += 1
        passed[kind] += verify(forged)[0] == 0
        found[kind] += verify(forged, witness)[0] == 1
        shutil.rmtree(forged.parent)
    print(
        "| forgery, all digests and tables anew | done | passes without a witness | found by it |"
    )
    print("| --- | --- | --- | --- |")
    for kind in FORGERIES:
        print(f"| {kind} | {done[kind]} | {passed[kind]} | {found[kind]} |")
    print(f"| all | {done.total()} | {passed.total()} | {found.total()} |\n")


def forged_records(study: Path, change: Callable[[list[Record]], list[Record]]) -> None:
    """Changes the journal of one session, and chains, seals and tables all anew."""
    path = min(study.glob("*/S001/journal.jsonl"))
    path.write_bytes(journal_bytes(change(read_journal(path))))
    seal_anew(study, lambda record: True)


def seal_anew(study: Path, keep: Callable[[Record], bool]) -> None:
    """Writes the journal of the study anew with the present ends of all sessions."""
    folder = StudyFolder.at(study)
    records = [record for record in folder.records() if keep(record)]
    for record in records:
        if record["kind"] == "sealed":
            journal = study / record["ppid"] / f"S{record['session']:03d}/journal.jsonl"
            there = read_journal(journal)
            record |= {"records": len(there), "digest_of_last": there[-1]["digest"]}
    (study / "study.jsonl").write_bytes(journal_bytes(records))
    rebuild_all(folder)


def other_result(study: Path, chance: random.Random) -> None:
    """The result of a trial is another one."""

    def change(records: list[Record]) -> list[Record]:
        end = chance.choice([r for r in records if r["kind"] == "trial_end"])
        end["result"]["success"] = not end["result"]["success"]
        return records

    forged_records(study, change)


def other_answer(study: Path, chance: random.Random) -> None:
    """An answer is another one."""

    def change(records: list[Record]) -> list[Record]:
        said = chance.choice([r for r in records if r["kind"] == "answers"])
        said["answers"] = {k: (v or 0) + 5 for k, v in said["answers"].items()}
        return records

    forged_records(study, change)


def no_trial(study: Path, chance: random.Random) -> None:
    """The last trial is gone, with its files."""

    def change(records: list[Record]) -> list[Record]:
        for path in min(study.glob("*/S001")).glob(f"*/*T{TRIALS:03d}*"):
            path.unlink()
        return [record for record in records if record.get("trial") != TRIALS]

    forged_records(study, change)


def excluded_trial(study: Path, chance: random.Random) -> None:
    """A trial is excluded by a record that nobody wrote."""

    def change(records: list[Record]) -> list[Record]:
        trial = chance.randrange(1, TRIALS + 1)
        note = {**records[-1], "kind": "exclude", "trial": trial, "reason": "the phone rang"}
        return [*records[:-1], note, records[-1]]

    forged_records(study, change)


def no_participant(study: Path, chance: random.Random) -> None:
    """A participant is gone without a withdrawal."""
    person = chance.choice(StudyFolder.at(study).participants())
    shutil.rmtree(study / person.ppid)
    seal_anew(study, lambda record: record.get("ppid") != person.ppid)


FORGERIES: dict[str, Callable[[Path, random.Random], None]] = {
    "another result": other_result,
    "another answer": other_answer,
    "a trial gone": no_trial,
    "a trial excluded": excluded_trial,
    "a participant gone": no_participant,
}


def kill_often(out: Path, count: int, chance: random.Random) -> None:
    """Kills studies and resumes them; prints what was lost, and how verification ended."""
    kills = studies = lost = failed = failed_after = broken = 0
    for study, killed, whole in killed_runs(out, count, chance):
        if killed:
            kills += 1
            lost += not whole
            findings = (
                audit(study.path).findings.found if (study.path / "study.jsonl").exists() else []
            )
            failed += bool(findings)
            print("".join(f"{finding}\n" for finding in findings), end="")
            continue
        status, said = verify(study.path)
        studies += 1
        failed_after += status != 0
        broken += len(BROKEN_OFF.findall(said)) and int(BROKEN_OFF.findall(said)[0])
        print(said if status else "", end="")
    print("| kills | with a trial or record lost | with a finding right after the kill |")
    print("| --- | --- | --- |")
    print(f"| {kills} | {lost} | {failed} |\n")
    print("| studies resumed to their end | broken-off attempts in them | verification not 0 |")
    print("| --- | --- | --- |")
    print(f"| {studies} | {broken} | {failed_after} |")


def killed_runs(
    out: Path, count: int, chance: random.Random
) -> Iterator[tuple[StudyFolder, bool, bool]]:
    """Yields every study after each kill, and after its end.

    Yields:
        The study; True if it was killed; True if every trial and record from before is there.
    """
    began = time.perf_counter()
    simulate(open_study(out / "whole"), 1, False, lambda text: None)
    whole = time.perf_counter() - began
    kills = number = 0
    while kills < count:
        study = open_study(out / f"study{number}")
        number += 1
        killed, finished = True, 0
        before: list[str] = []
        while killed:
            wait = chance.uniform(0.0, whole / 2) if kills < count else WHOLE
            child = in_child(lambda say, study=study: simulate(study, 1, True, say))  # type: ignore[misc]
            killed, said = killed_after(child, wait)
            kills += killed
            finished = check_session(study, 0, max(finished, told_finished(said)))
            journals = sorted(study.path.glob("*/S001/journal.jsonl"))
            digests = [record["digest"] for path in journals for record in read_journal(path)]
            yield study, killed, digests[: len(before)] == before
            before = digests
        assert finished == TRIALS


if __name__ == "__main__":
    main()
