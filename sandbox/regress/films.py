"""Films of the trials that moved most in a loss, beside those of the baseline's program.

Only the program of the baseline can film what it did: the page names it, and has for every trial
the line that makes the film and the place where it is shown.
"""

from __future__ import annotations

import shlex
from contextlib import ExitStack
from pathlib import Path

from sandbox.regress.baseline import Baseline
from sandbox.regress.plan import file_name, registered
from sandbox.regress.report import Report
from sandbox.session.session import Session
from sandbox.system.files import write_whole
from sandbox.trial.driver import View, play_trial
from sandbox.views.film import FilmView

PAGE = "films.md"
"""Name of the page that shows the films."""


def film_lost(report: Report, baseline: Baseline, folder: Path) -> None:
    """Films the trials, and writes the page.

    Args:
        report: The report; without a loss there is nothing to film.
        baseline: The baseline.
        folder: Folder of the films.

    Raises:
        GraphicsError: This machine has no OpenGL.
        InputError: A film or the page cannot be written.
    """
    moved = report.moved_most()
    jobs = {(job.name, job.seed): job for job in report.plan.jobs()}
    lines = [
        "# Trials that moved most",
        "",
        f"Before: {baseline.origin}. Films of before are made by that program, in this folder, by "
        "the lines below.",
    ]
    for trial in moved:
        job = jobs[trial.name, trial.seed]
        now = file_name(trial.name, trial.seed).replace(".jsonl", ".webp")
        before = f"before-{now}"
        with ExitStack() as closing, registered(job.own_task):

            def views(session: Session, path: Path = folder / now) -> list[View]:
                film = FilmView(
                    path, session.scene, session.whole_surface, caption="simulated user"
                )
                return [closing.enter_context(film).show]

            play_trial(job.settings, make_views=views)
        run = report.plan.run_words(trial.name, trial.seed)
        lines += ["", f"## {trial.name}, seed {trial.seed}", "", trial.what, ""]
        lines += ["| before | now |", "| --- | --- |", f"| ![]({before}) | ![]({now}) |"]
        if run:
            lines += ["", f"    {shlex.join([*run, '--film', before])}"]
    write_whole(folder / PAGE, "\n".join(lines) + "\n", "--film-lost")
