"""Noise floor of `sandbox regress`: the drop of success that so many paired seeds notice.

python -m benchmarks.noise_floor
"""

from __future__ import annotations

from sandbox.regress.statistics import POWER, fewest_losses, noticeable_drop

PAIRS = (30, 60, 120, 300, 600)
CASES = ((1, 0.0), (1, 0.02), (6, 0.0), (6, 0.02))
"""(tasks tested together, share of pairs won at the same time)."""


def main() -> None:
    """Prints the table in percentage points."""
    heads = [f"{tasks} task{'s' * (tasks > 1)}, {100 * win:.0f} % won" for tasks, win in CASES]
    print(f"drop noticed with {POWER:.0%} power, percentage points")
    print("| pairs | " + " | ".join(heads) + " |\n| --- |" + " --- |" * len(CASES))
    for pairs in PAIRS:
        drops = [noticeable_drop(pairs, win, tasks) for tasks, win in CASES]
        cells = ["none" if d is None else f"{100 * d:.1f}" for d in drops]
        print(f"| {pairs} | " + " | ".join(cells) + " |")
    print("fewest losses without a win: " + ", ".join(f"{t}: {fewest_losses(t)}" for t in (1, 6)))


if __name__ == "__main__":
    main()
