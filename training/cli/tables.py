"""`python -m training tables`: the tables of `sandbox evaluate` on the second simulated subject."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from sandbox.cli.common.command_line import parse
from sandbox.cli.evaluate import EvaluateOptions, measure
from training.judged import subject


@dataclass(frozen=True, kw_only=True)
class TablesOptions:
    """Measures encoders on the second SIMULATED subject. The tables are those of `sandbox
    evaluate`, whose help explains them. Encoders are trained on day 0 of that subject, and tested
    on other days.

    Try:

        python -m training tables --encoders linear quadratic --days 1
    """

    encoders: Annotated[
        tuple[str, ...], Parameter(metavar="NAME|FILE|FILE.py:CLASS", consume_multiple=True)
    ] = EvaluateOptions.encoders
    """Encoders to evaluate."""

    days: int = EvaluateOptions.days
    """Number of test days."""

    day_seed: int = EvaluateOptions.day_seed
    """Seed that chooses the test days."""

    json: Annotated[Path | None, Parameter(metavar="OUT")] = None
    """File for all numbers as JSON; - is the terminal."""

    plots: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """Folder for pictures of the tables and hands, as PNG and SVG. Needs the extra `plots`."""

    copas: Annotated[bool, Parameter(negative="--no-copas")] = EvaluateOptions.copas
    """Run the Copas test, which trains every encoder twenty more times."""


def main(argv: list[str]) -> int:
    """Runs `python -m training tables ...`."""
    options = parse(TablesOptions, "python -m training tables", argv)
    return measure(EvaluateOptions(**vars(options)), subject("second"))
