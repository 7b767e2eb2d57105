"""`sandbox study simulate`: runs a study with simulated participants."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.message import counted
from sandbox.cli.study.plan import participants_of
from sandbox.cli.study.printing import say_findings, say_noted, sayer

File = Annotated[Path, Parameter(metavar="DESIGN")]


@dataclass(frozen=True, kw_only=True)
class StudySimulateOptions:
    """Runs a study with simulated participants of different skill and hand size.

    Their data go to a separate folder, NAME-simulated, and every row is marked as simulated.
    """

    file: File = field(kw_only=False)
    """Design file."""

    out: Annotated[Path, Parameter(metavar="DIR")]
    """Folder of studies."""

    participants: Annotated[int | None, Parameter(metavar="N")] = None
    """Number of participants. Default: the number in the design."""

    site: Annotated[str, Parameter(metavar="LETTER")] = "A"
    """Letter of the place of these participants. Each place numbers its own participants."""

    resume: bool = False
    """Continue an earlier run, even if it was interrupted."""

    force_upgrade: Annotated[str, Parameter(metavar="REASON")] = ""
    """Continue although program, encoder or design have changed; the reason is recorded."""


def simulate(options: StudySimulateOptions, console: Console) -> int:
    """Runs `sandbox study simulate`."""
    from sandbox.study.design.checks import findings
    from sandbox.study.design.design_file import load_design
    from sandbox.study.record.folder import SIMULATED, StudyFolder
    from sandbox.study.run import simulated_study as simulated

    design = load_design(options.file)
    count = participants_of(options.participants, design)
    say_findings(findings(design), console)
    study = StudyFolder(options.out, design, SIMULATED, options.force_upgrade, options.site)
    say_noted(study, sayer(console))
    done = simulated.simulate(study, count, options.resume, sayer(console))
    console.print(
        f"{escape(str(study.path))}: {counted(done['participants'], 'simulated participant')}, "
        f"{counted(done['trials'], 'trial that counts', 'trials that count')}, "
        f"{done['excluded']} excluded"
    )
    return 0
