"""Whether R says the same as a study's report: its `analysis.R` is run on a planted study.

python -m benchmarks.report_in_r

Needs `Rscript` with lme4; survival and geepack are used where they are there (Debian: r-base-core,
r-cran-lme4, r-cran-survival, r-cran-geepack).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from sandbox.study.report.make import SCRIPT, make_report
from tools.planted_study import Truth, write_study

KEYS = ["measure", "model", "factor", "first", "second"]


def main() -> None:
    """Prints both sides' estimates and standard errors."""
    if shutil.which("Rscript") is None:
        sys.exit("there is no Rscript on this machine")
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder)
        write_study(study, Truth(), 0)
        out = make_report(study, study / "report").parent
        run = subprocess.run(
            ["Rscript", SCRIPT], cwd=out, capture_output=True, text=True, timeout=300, check=False
        )
        if run.returncode:
            sys.exit(run.stderr)
        here = pd.read_csv(out / "comparisons.csv")
        there = pd.read_csv(out / "comparisons_R.csv")
    here["estimate"] = np.log(here["estimate"].where(here["kind"] != "difference"))
    both = here.merge(there, on=KEYS, suffixes=("", "_R"))
    print("estimates are logarithms of ratios and of odds ratios")
    print(both[[*KEYS, "estimate", "estimate_R", "error", "error_R"]].to_string(
        index=False, float_format=lambda x: f"{x:.5f}"))  # fmt: skip
    for model, rows in both.groupby("model"):
        print(f"{model}: largest difference of estimates "
              f"{(rows['estimate'] - rows['estimate_R']).abs().max():.1e}, of standard errors "
              f"{(rows['error'] / rows['error_R'] - 1).abs().max():.1e} of themselves")  # fmt: skip


if __name__ == "__main__":
    main()
