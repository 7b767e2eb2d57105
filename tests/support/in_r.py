"""What R reads from tables; its callers need `r`."""

from __future__ import annotations

import subprocess
from pathlib import Path

READ = """
words <- function(file) read.csv(file, colClasses = "character", check.names = FALSE,
                                 na.strings = character(0), encoding = "UTF-8")
given <- commandArgs(trailingOnly = TRUE)
"""
"""`words` reads all cells of a table as text, as analysis.R does."""


def in_r(script: str, *files: Path) -> list[str]:
    """Runs a script after `READ`, with some files in `given`; the lines that it prints.

    Raises:
        CalledProcessError: R ended with an error.
    """
    command = ["Rscript", "--vanilla", "-e", READ + script, *map(str, files)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
