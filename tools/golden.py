"""What users see of the program, written to files, so that a change of it is noticed.

    python -m tools.golden write FOLDER     # help, JSON keys, table headers, state hashes, exports
    python -m tools.golden compare FOLDER   # the same again; exit status 1 if anything differs

State hashes and exports are equal only on machines with the same fingerprint.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import difflib
import io
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

from sandbox.cli.main import COMMANDS, main

SUBCOMMANDS = {
    "study": "new check plan sheet run simulate report recover export backup merge withdraw",
    "touches": "show record send formats",
    "paalm": "show calibrate",
    "leap": "fake simulate formats",
    "robot": "fit show",
    "webcam": "install status record",
    "capture": "record report simulate",
}
"""Commands that have commands of their own, and these."""

TASKS = (
    "box-to-goal",
    "wrench-turn",
    "wrench-slide",
    "stack",
    "stack-three",
    "stack-vertical",
    "carry-together",
    "slalom",
    "chords",
    "dial",
    "gather",
    "books",
    "insert",
    "close-case",
    "single-keys",
)
ENCODERS = ("linear", "quadratic", "cubic", "pca-ik", "paper")
RUNS = [
    *(f"{task} --seed 1" for task in TASKS),
    *(f"box-to-goal --seed 2 --encoder {encoder}" for encoder in ENCODERS),
    "box-to-goal --seed 2 --bare",
    "wrench-turn --seed 3 --hand left --turn 180 --hand-size 0.9",
    "stack --seed 3 --servo position --impulse safe --contact soft",
    "box-to-goal --seed 4 --fingers 2 --drop-outs 0.3",
    "stack --seed 2 --device leap-simulated",
    "box-to-goal --seed 2 --device leap-simulated:v1",
    "carry-together --seed 2 --device leap-simulated",
    "wrench-slide --seed 5 --fingers 5 --vary size=1.2",
]
"""Trials: a recording for every task, encoder, kind of hand and device without hardware."""

EXPORTS = ("bvh", "glb", "amc", "v", "vsk", "c3d", "csv")


def command(line: str) -> str:
    """What a command prints to standard output; its exit status must be 0 or 1.

    Args:
        line: Words after `sandbox`, separated by blanks.
    """
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()) as errors:
        try:
            status = main(line.split())
        except SystemExit as end:
            status = int(end.code or 0)
    if status not in (0, 1):
        raise SystemExit(f"sandbox {line} ended with {status}: {errors.getvalue()}")
    return out.getvalue()


def keys_of(value: Any, place: str = "") -> Iterator[str]:
    """Paths of all keys in a JSON value; items of a list are one place."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield f"{place}.{key}"
            yield from keys_of(inner, f"{place}.{key}")
    elif isinstance(value, list):
        for inner in value:
            yield from keys_of(inner, f"{place}[]")


def helps() -> Iterator[tuple[str, str]]:
    """File name and help text of every command and subcommand."""
    yield "sandbox.txt", command("--help")
    for name in COMMANDS:
        yield f"{name}.txt", command(f"{name} --help")
        for sub in SUBCOMMANDS.get(name, "").split():
            yield f"{name}-{sub}.txt", command(f"{name} {sub} --help")


def key_lists(work: Path) -> Iterator[tuple[str, str]]:
    """File name and sorted keys of what commands say in JSON."""
    recording = work / "touches.jsonl"
    command(f"run box-to-goal --seed 1 --record {recording}")
    texts = {
        "run": [command("run box-to-goal --seed 1 --json -")],
        "regress": [command("regress --tasks box-to-goal --seeds 0:2 --executor serial --json -")],
        "touches-show": command(f"touches show --device {recording} --json").splitlines(),
        "evaluate": [
            command(f"evaluate --encoders best --days 1 --json {work / 'evaluate.json'}")
            and (work / "evaluate.json").read_text()
        ],
    }
    for name, lines in texts.items():
        keys = {key for line in lines for key in keys_of(json.loads(line))}
        yield f"keys-{name}.txt", "\n".join(sorted(keys)) + "\n"


def study_headers(work: Path) -> Iterator[tuple[str, str]]:
    """File name and header of every table of a simulated study and of its report."""
    design = Path(__file__).resolve().parent.parent / "examples" / "study" / "design.toml"
    command(f"study simulate {design} --out {work / 'study'} --participants 2")
    study = next((work / "study").glob("*/design.toml"), work / "study" / "design.toml").parent
    command(f"study report {study}")
    headers = {}
    for path in sorted(study.rglob("*.csv")):
        with path.open(newline="") as file:
            inner = path.relative_to(study).parts[:-1]
            place = {(): "", ("report",): "report/"}.get(inner, "PARTICIPANT/")
            headers[place + path.name] = next(csv.reader(file))
    text = "".join(f"{name}: {', '.join(header)}\n" for name, header in sorted(headers.items()))
    yield "study-tables.txt", text


def hashes(work: Path) -> Iterator[tuple[str, str]]:
    """State hashes of trials, each also replayed, and digests of the first one's exports."""
    rows = {}
    for i, run in enumerate(RUNS):
        recording = work / f"{i}.jsonl"
        result = json.loads(command(f"run {run} --json - --record {recording}"))
        replayed = command(f"replay {recording} --view none")
        rows[run] = f"{result['state_hash']} {result['status']} {replayed.splitlines()[0]}"
        print(run, rows[run], file=sys.stderr, flush=True)
    yield "states.json", json.dumps(rows, indent=1) + "\n"
    digests = {}
    for kind in EXPORTS:
        command(f"export {work / '0.jsonl'} --to {work / f'hand.{kind}'}")
    for path in sorted(work.glob("hand.*")):
        digests[path.name] = sha256(path.read_bytes()).hexdigest()
    yield "exports.json", json.dumps(digests, indent=1) + "\n"


def golden(only: str) -> Iterator[tuple[str, str]]:
    """All golden files as (name, text)."""
    os.environ.update(COLUMNS="100", NO_COLOR="1", TERM="dumb")
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        if "help" in only:
            yield from helps()
        if "keys" in only:
            yield from key_lists(work)
        if "study" in only:
            yield from study_headers(work)
        if "states" in only:
            yield from hashes(work)


def run() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("do", choices=("write", "compare"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", default="help,keys,study,states", help="parts, with commas")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    differs = False
    for name, text in golden(options.only):
        path = options.folder / name
        if options.do == "write":
            path.write_text(text)
        elif (before := path.read_text() if path.exists() else "") != text:
            differs = True
            sys.stdout.writelines(
                difflib.unified_diff(
                    before.splitlines(True), text.splitlines(True), f"before/{name}", f"now/{name}"
                )
            )
    return int(differs)


if __name__ == "__main__":
    sys.exit(run())
