"""Plants faults in copies of the program, one at a time, and counts what `sandbox regress` finds.

A fault is a few lines of the source that are replaced. The unchanged program makes a baseline; each
copy is compared with it by the command that a CI server runs, `sandbox regress --baseline`. Neutral
changes must not be found: they move the bits of a trial and nothing else.

    python -m benchmarks.planted_faults --out out/faults.jsonl
    python -m benchmarks.planted_faults --out out/faults.jsonl --table
    python -m benchmarks.planted_faults --out out/neutral.jsonl --neutral

What follows `--` is passed to every `sandbox regress`, such as `-- --seeds 0:30 --tasks stack`. The
file has a line for every change; those that it has are not run again.
"""

from __future__ import annotations

import argparse
import json
import os
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

ROOT = Path(__file__).parents[1]
PACKAGES = ("models", "encoders", "tasks", "sandbox")


@dataclass(frozen=True)
class Change:
    """A change of the program.

    Attributes:
        name: What it is, in words.
        edits: Pairs of texts: the first stands in one file of the packages, once, and is replaced
            by the second.
        neutral: True if it makes no task harder or easier.
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
                "frame = replace(self._seated.touch(max(now - 0.05, 0.0)), time=now)\n",
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
                'DISTANCE = (0.050, 0.100)\n"""m from start to goal."""\nROOM',
                'DISTANCE = (0.040, 0.090)\n"""m from start to goal."""\nROOM',
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
"""Each changes what a trial measures: most make tasks harder, some easier."""

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
"""None makes a task harder or easier; most change the bits of every trial."""


def copied(change: Change | None, folder: Path) -> None:
    """Writes a copy of the packages with a change.

    Raises:
        SystemExit: A text of the change does not stand in exactly one place.
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


def regress(folder: Path, *words: str) -> tuple[int, str]:
    """Runs `sandbox regress` of a copy; exit status and what it printed."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"}
    run = subprocess.run(
        [sys.executable, "-m", "sandbox", "regress", *words],
        cwd=folder,
        env=environment,
        check=False,
        capture_output=True,
        text=True,
    )
    if run.returncode not in (0, 1):
        raise SystemExit(run.stderr[-2000:] or run.stdout[-2000:])
    return run.returncode, run.stdout


@contextmanager
def copy_of(change: Change | None) -> Iterator[Path]:
    """A folder with a copy of the program, which is removed afterwards."""
    with tempfile.TemporaryDirectory() as name:
        copied(change, Path(name))
        yield Path(name)


def measured(change: Change, baseline: Path, words: Sequence[str]) -> dict[str, Any]:
    """Compares a changed program with the baseline."""
    began = perf_counter()
    with copy_of(change) as folder:
        out = folder / "report.json"
        status, _ = regress(folder, "--baseline", str(baseline), "--json", str(out), *words)
        report = json.loads(out.read_text())
    return {
        "change": change.name,
        "neutral": change.neutral,
        "loss": status == 1,
        "reasons": report["reasons"],
        "gains": report["gains"],
        "changes": _changes(report),
        "wall_s": round(perf_counter() - began, 1),
    }


def _changes(report: dict[str, Any]) -> dict[str, dict[str, list[float]]]:
    """Change, and both p values, of every measure by task."""
    found = {name: task["baseline"]["measures"] for name, task in report["tasks"].items()}
    if report["together"]:
        found["all tasks"] = report["together"]
    return {
        name: {m: [c["change"], c["p_loss"], c["p_gain"]] for m, c in changes.items()}
        for name, changes in found.items()
    }


def table(rows: Sequence[dict[str, Any]], console: Console) -> None:
    """Prints what was found, what was missed, and the false alarms."""
    for neutral, title in ((False, "planted faults"), (True, "neutral changes")):
        own = [row for row in rows if row["neutral"] == neutral]
        if not own:
            continue
        shown = Table("change", "found", "by", "s", title=title)
        for row in own:
            found = "loss" if row["loss"] else "gain" if row["gains"] else "no"
            first = "; ".join((row["reasons"] or row["gains"] or [""])[:2])
            shown.add_row(row["change"], found, first, f"{row['wall_s']:.0f}")
        console.print(shown)
        count = sum(bool(row["loss"] or row["gains"]) for row in own)
        what = "false alarms" if neutral else "found"
        console.print(f"{count} of {len(own)} {what}")


def main() -> None:
    """Runs the bench."""
    argv, words = sys.argv[1:], []
    if "--" in argv:
        words, argv = argv[argv.index("--") + 1 :], argv[: argv.index("--")]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--neutral", action="store_true", help="neutral changes in place of faults")
    parser.add_argument("--only", default="", help="changes with this text in their name")
    parser.add_argument("--table", action="store_true", help="only print what the file has")
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
                regress(folder, "--baseline", str(baseline), "--update-baseline", *words)
        for change in NEUTRAL if args.neutral else FAULTS:
            if args.only not in change.name or any(r["change"] == change.name for r in rows):
                continue
            rows.append(measured(change, baseline, words))
            with args.out.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
            print(json.dumps(rows[-1]), flush=True)
    table(rows, Console(width=max(Console().width, 140)))


if __name__ == "__main__":
    main()
