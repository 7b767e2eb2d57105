"""Plants faults in copies of the program, one at a time, and counts what `sandbox regress` finds.

A fault replaces a few lines of the source. The unchanged program makes a baseline. Each copy plays
the same trials with `sandbox regress --baseline`, task after task. A fault is found, and the other
tasks are not played, as soon as a p value of a task times the number of all tests of a default run
is small enough: Holm's procedure would then report it for any results of the other tasks. If no
task alone is enough, the trials of all tasks are compared as one run.

Neutral changes must not be found: they only change the last bits of a trial. If a neutral change
leaves the first trials of every task equal to the bit, its other trials are not played. Otherwise
all seeds are played once, and half of them are drawn and compared, twenty times.

    python -m benchmarks.planted_faults --out out/faults.jsonl
    python -m benchmarks.planted_faults --out out/faults.jsonl --table
    python -m benchmarks.planted_faults --out out/neutral.jsonl --neutral

Words after `--` are options of every `sandbox regress`, such as `-- --seeds 0:30 --workers 1`. The
file has a line for every change. Changes in the file are not run again.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from rich.console import Console
from rich.table import Table

from sandbox.regress import statistics
from sandbox.regress.baseline import load_baseline
from sandbox.regress.compared_measures import DECIDING
from sandbox.regress.comparison import level_of
from sandbox.regress.execute import Trial
from sandbox.regress.run_plan import ARMS, RegressionPlan, arm_of, find_tasks
from sandbox.regress.run_report import Report, make_report

ROOT = Path(__file__).parents[1]
PACKAGES = ("models", "encoders", "tasks", "sandbox")


@dataclass(frozen=True)
class Change:
    """A change of the program.

    Attributes:
        name: Short description.
        edits: Pairs of texts. The first text occurs once in one file of the packages, and is
            replaced by the second.
        neutral: True if the change makes no task harder or easier.
    """

    name: str
    edits: tuple[tuple[str, str], ...]
    neutral: bool = False


FAULTS = (
    Change(
        "friction of the table 30 % lower",
        (("{spec.table_friction:.9g} .01 .0001", "{0.7 * spec.table_friction:.9g} .01 .0001"),),
    ),
    Change(
        "friction of the table 40 % higher",
        (("{spec.table_friction:.9g} .01 .0001", "{1.4 * spec.table_friction:.9g} .01 .0001"),),
    ),
    Change(
        "friction of fingertips on objects 30 % lower",
        (
            (
                '"friction": f"{friction:.9g} .01 .0001",',
                '"friction": f"{0.7 * friction:.9g} .01 .0001",',
            ),
            (
                '"friction": "1 .01 .0001",\n            "density"',
                '"friction": ".7 .01 .0001",\n            "density"',
            ),
        ),
    ),
    Change(
        "friction of fingertips 50 % higher",
        (
            (
                '"friction": "1 .01 .0001",\n            "density"',
                '"friction": "1.5 .01 .0001",\n            "density"',
            ),
        ),
    ),
    Change(
        "boxes 8 % larger",
        (("mjcf_text(self.half_size)", "mjcf_text([1.08 * x for x in self.half_size])"),),
    ),
    Change(
        "objects twice as heavy",
        (
            (
                '"mass": f"{mass:.9g}",\n        "contype"',
                '"mass": f"{2.0 * mass:.9g}",\n        "contype"',
            ),
        ),
    ),
    Change(
        "half of the fingertips' correction",
        (("        return corrected.q\n", "        return guess + 0.5 * (corrected.q - guess)\n"),),
    ),
    Change(
        "no correction of fingertips",
        (
            (
                "        return corrected.q\n",
                "        return within_limits(guess, self._skeleton)\n",
            ),
        ),
    ),
    Change(
        "index and middle finger swapped",
        (
            (
                "self._labels = self._labelling.labels\n",
                "swapped = {1: 2, 2: 1}\n        named = self._labelling.labels\n"
                "        self._labels = {i: swapped.get(f, f) for i, f in named.items()}\n",
            ),
        ),
    ),
    Change(
        "labels 0.3 s late",
        (("time - self._changed_at < settle - 1e-9", "time - self._changed_at < settle + 0.3"),),
    ),
    Change(
        "speed limit of the hand at 40 %",
        (
            (
                "    linear: float = 1.0\n    angular: float = 12.0",
                "    linear: float = 0.4\n    angular: float = 4.8",
            ),
        ),
    ),
    Change(
        "servos of the palm at 30 % of their stiffness",
        (
            (
                "ROOT_STIFFNESS, ROOT_TURN_STIFFNESS = 8000.0, 40.0",
                "ROOT_STIFFNESS, ROOT_TURN_STIFFNESS = 2400.0, 12.0",
            ),
        ),
    ),
    Change("impulse limit of 0.15 N s", (('{"paper": 100.0,', '{"paper": 0.15,'),)),
    Change(
        "touches 50 ms late",
        (
            (
                "frame = self._seated.touch(now)\n",
                "late = [*getattr(self, '_late', ()), self._seated.touch(now)][-4:]\n"
                "        self._late = late\n        frame = replace(late[0], time=now)\n",
            ),
        ),
    ),
    Change(
        "touches with twice the noise",
        (("actual = [a + b + size * c for", "actual = [a + 2.0 * (b + size * c) for"),),
    ),
    Change(
        "lost contacts are not carried",
        (
            (
                "    grace: float = 0.15\n    cancelled_grace: float = 0.35",
                "    grace: float = 0.0\n    cancelled_grace: float = 0.0",
            ),
            # The simulated screen loses a contact now and then in both programs.
        ),
    ),
    Change(
        "fingers solid inside objects",
        (
            (
                "if self._rules.ghost_until_clear else True",
                "if self._rules.ghost_until_clear and False else True",
            ),
        ),
    ),
    Change(
        "tolerance of box-to-goal and stack at 60 %",
        (
            (
                "POSITION_TOLERANCE = 0.010\nYAW_TOLERANCE = np.deg2rad(10.0)",
                "POSITION_TOLERANCE = 0.006\nYAW_TOLERANCE = np.deg2rad(6.0)",
            ),
        ),
    ),
    Change(
        "goal of box-to-goal 1 cm nearer",
        (
            (
                "places = surface.to_world(np.stack([start, end]))\n        half = EDGE / 2",
                "end = start + (1.0 - 0.01 / distance) * (end - start)\n"
                "        places = surface.to_world(np.stack([start, end]))\n"
                "        half = EDGE / 2",
            ),
        ),
    ),
    Change(
        "steps of physics of 4 ms",
        (
            (
                "timestep: Annotated[float, msgspec.Meta(gt=0.0, lt=1.0)] = 0.002",
                "timestep: Annotated[float, msgspec.Meta(gt=0.0, lt=1.0)] = 0.004",
            ),
        ),
    ),
    Change(
        "a score that never drops",
        (
            (
                "        if not reached:\n            self._since = None\n"
                "            return False\n",
                "        if not reached and self._since is None:\n            return False\n",
            ),
        ),
    ),
)
"""Changes that affect the results of trials. Most make tasks harder, some easier."""

_TINY = "* (1.0 + 1e-9)"
NEUTRAL = (
    Change(
        "friction of the table times 1 + 1e-9",
        (
            (
                "{spec.table_friction:.9g} .01 .0001",
                f"{{spec.table_friction {_TINY}:.12g}} .01 .0001",
            ),
        ),
        True,
    ),
    Change(
        "friction of objects times 1 + 1e-9",
        (
            (
                '"friction": f"{friction:.9g} .01 .0001",',
                f'"friction": f"{{friction {_TINY}:.12g}} .01 .0001",',
            ),
        ),
        True,
    ),
    Change(
        "mass of objects times 1 + 1e-9",
        (
            (
                '"mass": f"{mass:.9g}",\n        "contype"',
                f'"mass": f"{{mass {_TINY}:.12g}}",\n        "contype"',
            ),
        ),
        True,
    ),
    Change(
        "sum of squares in another order",
        (
            (
                "(squares[::3] + squares[2::3] + squares[1::3])",
                "(squares[::3] + squares[1::3] + squares[2::3])",
            ),
        ),
        True,
    ),
    Change(
        "servos times 1 + 1e-9",
        (
            (
                "ROOT_STIFFNESS, ROOT_TURN_STIFFNESS = 8000.0, 40.0",
                f"ROOT_STIFFNESS, ROOT_TURN_STIFFNESS = 8000.0 {_TINY}, 40.0",
            ),
        ),
        True,
    ),
    Change(
        "one more random number of the user",
        (
            (
                "        drawn, many = self._rng.standard_normal(4 * self._c.fingers).tolist()",
                "        self._rng.normal()\n"
                "        drawn, many = self._rng.standard_normal(4 * self._c.fingers).tolist()",
            ),
        ),
        True,
    ),
    Change(
        "noise in another order",
        (("actual = [a + b + size * c for", "actual = [a + (b + size * c) for"),),
        True,
    ),
    Change(
        "box-to-goal described otherwise",
        (('"""Bring a 5 cm box onto its translucent twin.', '"""Bring a box onto its twin.'),),
        True,
    ),
    Change(
        "corrected pose times 1 + 1e-12",
        (("        return corrected.q\n", "        return corrected.q * (1.0 + 1e-12)\n"),),
        True,
    ),
    Change(
        "speed limit times 1 + 1e-9",
        (
            (
                "    linear: float = 1.0\n    angular: float = 12.0",
                f"    linear: float = 1.0 {_TINY}\n    angular: float = 12.0",
            ),
        ),
        True,
    ),
)
"""Changes that make no task harder or easier. Most change the last bits of every trial."""


def copied(change: Change | None, folder: Path) -> None:
    """Writes a copy of the packages with a change.

    Raises:
        SystemExit: A text of the change does not occur exactly once.
    """
    for name in PACKAGES:
        shutil.copytree(
            ROOT / name,
            folder / name,
            ignore=shutil.ignore_patterns("__pycache__", "node_modules", "src"),
        )
    for old, new in () if change is None else change.edits:
        files = [
            f for name in PACKAGES for f in (folder / name).rglob("*.py") if old in f.read_text()
        ]
        if len(files) != 1 or files[0].read_text().count(old) != 1:
            assert change is not None
            raise SystemExit(
                f"{change.name}: this text is in {len(files)} files, not in one: {old}"
            )
        files[0].write_text(files[0].read_text().replace(old, new))


class RefusedError(Exception):
    """`sandbox regress` of a copy refuses its input: it ends with status 2."""


def regress(folder: Path, *words: str) -> tuple[int, str]:
    """Runs `sandbox regress` of a copy.

    Returns:
        Exit status (0 or 1) and standard output.

    Raises:
        RefusedError: The copy refuses its input. The text is the last line that it prints.
        SystemExit: The run ends with another status.
    """
    environment = {**os.environ, "PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"}
    run = subprocess.run(
        [sys.executable, "-m", "sandbox", "regress", *words],
        cwd=folder,
        env=environment,
        check=False,
        capture_output=True,
        text=True,
    )
    if run.returncode == 2 and run.stderr.strip():
        raise RefusedError(run.stderr.strip().splitlines()[-1])
    if run.returncode not in (0, 1):
        raise SystemExit(run.stderr[-2000:] or run.stdout[-2000:])
    return run.returncode, run.stdout


@contextmanager
def copy_of(change: Change | None) -> Iterator[Path]:
    """Yields a temporary folder with a copy of the program."""
    with tempfile.TemporaryDirectory() as name:
        copied(change, Path(name))
        yield Path(name)


ORDER = (
    "box-to-goal",
    "wrench-turn",
    "chords",
    "wrench-slide",
    "stack",
    "books",
    "stack-vertical",
    "insert",
    "slalom",
    "dial",
    "single-keys",
    "stack-three",
    "close-case",
    "carry-together",
    "gather",
)
"""Tasks in the order of play. Tasks with short trials come first."""
DRAWS = 20
"""Number of draws of half the seeds for a neutral change."""
LOOK = 2
"""Number of seeds of every task that are played first, to test whether a change has an effect."""


def played(
    folder: Path, baseline: Path, tasks: Sequence[str], words: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """Yields the reports of `sandbox regress` of a copy, task after task."""
    out = folder / "report.json"
    for task in tasks:
        regress(folder, "--tasks", task, "--baseline", str(baseline), "--json", str(out), *words)
        yield json.loads(out.read_text())


def compared(baseline: Path, tasks: Sequence[str], trials: Sequence[Trial]) -> Report:
    """Compares trials of several runs with the baseline, as if they were of one run."""
    seeds = tuple(dict.fromkeys(trial["seed"] for trial in trials))
    arms = tuple(dict.fromkeys(arm_of(trial["task"]) for trial in trials))
    return make_report(
        RegressionPlan(tuple(tasks), seeds, arms=arms), trials, load_baseline(baseline)
    )


def decided(report: dict[str, Any], tests: int) -> str:
    """Returns the first change of a report that is beyond chance among `tests` tests, as text. It
    is empty if there is none."""
    measures = {name: task["baseline"]["measures"] for name, task in report["tasks"].items()}
    own = len(measures) * len(DECIDING)
    for name, changes in measures.items():
        for measure in DECIDING:
            change = changes[measure]
            for kind, sign in (("loss", 1), ("gain", -1)):
                # The smallest of Holm's p values is that of its test times their number.
                p = change[f"p_{kind}"] * tests / own
                if p <= statistics.GATE and sign * change["change"] > 0.0:
                    moved = f"{measure} by {100 * abs(change['change']):.1f} %"
                    return f"{kind}, {name}: {moved}, p = {p:.1g}"
    return ""


def measured(
    change: Change, baseline: Path, tasks: Sequence[str], words: Sequence[str]
) -> dict[str, Any]:
    """Compares a changed program with the baseline until a task decides. Returns the line of the
    file."""
    began = perf_counter()
    before = load_baseline(baseline).tasks
    everything = RegressionPlan(find_tasks(["all"]), (0,), arms=ARMS["both"])
    tests = round(statistics.GATE / level_of(everything.names))
    trials: list[Trial] = []
    found = ""
    with copy_of(change) as folder:
        try:
            for report in played(folder, baseline, tasks, words):
                trials += report["trials"]
                found = decided(report, tests)
                if found:
                    break
        except RefusedError as refused:
            # A refused run fails with one line, so that it is not counted as passed.
            found = f"refused: {refused}"
    moved = []
    if not found:
        whole = compared(baseline, tasks, trials)
        texts = [f"loss, {r}" for r in whole.reasons] + [f"gain, {g}" for g in whole.gains]
        found = "; ".join(texts)
        moved = [
            change.text()
            for c in whole.comparisons.values()
            for measure, change in c.changes.items()
            if measure not in DECIDING and change.moved
        ]
    changed = sum(t["state_hash"] != before[t["task"]].trials[t["seed"]].state_hash for t in trials)
    return {
        "change": change.name,
        "neutral": False,
        "found": found,
        "moved": moved,
        "tasks": len({t["task"].partition(" ")[0] for t in trials}),
        "trials": len(trials),
        "changed": changed,
        "wall_s": round(perf_counter() - began, 1),
    }


def drawn(
    change: Change, baseline: Path, tasks: Sequence[str], words: Sequence[str]
) -> dict[str, Any]:
    """Counts the false alarms of a neutral change in draws of half the seeds. Returns the line of
    the file."""
    began = perf_counter()
    before = load_baseline(baseline).tasks
    seeds = sorted(next(iter(before.values())).trials)
    look = ["--seeds", ",".join(map(str, seeds[:LOOK]))]
    with copy_of(change) as folder:
        trials = [t for r in played(folder, baseline, tasks, [*words, *look]) for t in r["trials"]]
        changed = any(
            t["state_hash"] != before[t["task"]].trials[t["seed"]].state_hash for t in trials
        )
        if changed:
            trials = [t for r in played(folder, baseline, tasks, words) for t in r["trials"]]
    alarms = []
    for draw in range(DRAWS if changed else 0):
        some = set(random.Random(f"{change.name} {draw}").sample(seeds, len(seeds) // 2))
        report = compared(baseline, tasks, [t for t in trials if t["seed"] in some])
        alarms += [[*report.reasons, *report.gains]]
    return {
        "change": change.name,
        "neutral": True,
        "alarms": [alarm for alarm in alarms if alarm],
        "losses": sum(any("loss" in text for text in alarm) for alarm in alarms),
        "tasks": len(tasks),
        "trials": len(trials),
        "changed": sum(
            t["state_hash"] != before[t["task"]].trials[t["seed"]].state_hash for t in trials
        ),
        "wall_s": round(perf_counter() - began, 1),
    }


def table(rows: Sequence[dict[str, Any]], console: Console) -> None:
    """Prints found and missed faults, and false alarms."""
    faults = [row for row in rows if not row["neutral"]]
    if faults:
        shown = Table("change", "found", "tasks", "trials", "s", title="planted faults")
        for row in faults:
            counts = (row["tasks"], row["trials"], round(row["wall_s"]))
            shown.add_row(row["change"], row["found"] or "no", *map(str, counts))
        console.print(shown)
        console.print(f"{sum(bool(row['found']) for row in faults)} of {len(faults)} found")
    neutral = [row for row in rows if row["neutral"]]
    if neutral:
        shown = Table("change", "trials that differ", "false alarms", title="neutral changes")
        for row in neutral:
            differ = f"{row['changed']} of {row['trials']}"
            shown.add_row(row["change"], differ, f"{len(row['alarms'])} of {DRAWS}")
        console.print(shown)
        alarms = sum(len(row["alarms"]) for row in neutral)
        console.print(f"{alarms} false alarms in {DRAWS * len(neutral)} draws")


def main() -> None:
    """Plays the changes that are not in the file, and prints the tables."""
    argv, words = sys.argv[1:], []
    if "--" in argv:
        words, argv = argv[argv.index("--") + 1 :], argv[: argv.index("--")]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--neutral", action="store_true", help="play neutral changes, not faults")
    parser.add_argument("--only", default="", help="changes whose name contains this text")
    parser.add_argument("--tasks", nargs="*", default=ORDER, help="tasks in the order of play")
    parser.add_argument("--table", action="store_true", help="only print the contents of the file")
    args = parser.parse_args(argv)
    rows = (
        [json.loads(line) for line in args.out.read_text().splitlines()]
        if args.out.exists()
        else []
    )
    if not args.table:
        args.out.parent.mkdir(parents=True, exist_ok=True)
        baseline = args.out.with_name(f"{args.out.stem}.baseline.json").resolve()
        if not baseline.exists():
            with copy_of(None) as folder:
                made = ["--tasks", *args.tasks, "--baseline", str(baseline), "--update-baseline"]
                regress(folder, *made, *words)
        for change in NEUTRAL if args.neutral else FAULTS:
            if args.only not in change.name or any(r["change"] == change.name for r in rows):
                continue
            compare = drawn if change.neutral else measured
            rows.append(compare(change, baseline, args.tasks, words))
            with args.out.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
            print(json.dumps(rows[-1]), flush=True)
    table(rows, Console(width=max(Console().width, 140)))


if __name__ == "__main__":
    main()
