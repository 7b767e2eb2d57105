"""200 random studies, and what R computes of them: `found.csv`, where R is missing.

`python -m tests.sandbox.study.report.reference` computes it anew (Debian's r-base-core,
r-cran-survival and r-cran-coin).
"""

from __future__ import annotations

import csv
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.arithmetic import Array

SCRIPT = Path(__file__).with_name("reference.R")
FOUND = Path(__file__).with_name("reference.csv")
STUDIES = 200
LIMIT = 20.0
"""Time limit of trials, s."""
KINDS = ("plain", "shares", "times", "groups")


@dataclass(frozen=True)
class Drawn:
    """One number of each person under each of two conditions.

    Attributes:
        kind: `plain` numbers; `shares` of four trials, with ceilings; `times`, of which some are
            at the limit; `groups`, of different sizes, each with one condition.
        first, second: (n,) numbers by person; of two groups, those of both.
    """

    kind: str
    first: Array
    second: Array


def study(seed: int) -> Drawn:
    """Draws a study of 6 to 40 people; of shares to 13, of which R tries all signs."""
    rng = np.random.default_rng([seed, 21])
    kind = KINDS[seed % len(KINDS)]
    people = int(rng.integers(6, 14 if kind == "shares" else 41))
    skill, effect = rng.normal(0.0, 0.5, people), rng.choice([0.0, 0.4, 0.8])
    if kind == "groups":
        others = int(rng.integers(6, 41))
        return Drawn(kind, skill, rng.normal(effect, rng.choice([0.3, 0.5, 1.2]), others))
    noise = rng.normal(0.0, 0.5, (2, people))
    values = skill + noise + np.array([[0.0], [effect]])
    if kind == "shares":
        chances = 1.0 / (1.0 + np.exp(-1.5 - values))
        values = rng.binomial(4, chances) / 4
        if (values[0] == values[1]).all() or np.ptp(values[1] - values[0]) == 0.0:
            values[1, 0] = 1.0 - values[0, 0]
    if kind == "times":
        values = np.minimum(12.0 * np.exp(values), LIMIT)
        if np.ptp(values[1] - values[0]) == 0.0:
            values[1, 0] /= 2.0
    return Drawn(kind, *values)


def in_r() -> list[dict[str, str]]:
    """What R computes of all studies now, a row each."""
    with tempfile.TemporaryDirectory() as folder:
        numbers, found = (Path(folder) / name for name in ("numbers.csv", "found.csv"))
        with numbers.open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(["study", "kind", "side", "value"])
            for seed in range(STUDIES):
                drawn = study(seed)
                for side in ("first", "second"):
                    for value in getattr(drawn, side):
                        rows.writerow([seed, drawn.kind, side, repr(float(value))])
        subprocess.run(
            ["Rscript", str(SCRIPT), str(numbers), str(found)], check=True, capture_output=True
        )
        return read(found)


def read(path: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


if __name__ == "__main__":
    table = in_r()
    with FOUND.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
