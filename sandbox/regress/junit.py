"""The report as JUnit's XML, which CI servers draw: one test for every task."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from models.message import counted
from sandbox.regress.report import Report, TaskResult
from sandbox.system.files import write_whole

_ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 cannot hold, not even escaped."""


def junit(report: Report) -> str:
    """XML with a test for every task.

    A loss beyond chance is a failure, and trials that crashed are an error; both together are an
    error that names both. Crashes that are allowed are only told of. The output names failed seeds
    and how to see them again. Tests have no `time`: a trial knows simulated time alone.
    """
    suite = ElementTree.Element("testsuite", name="sandbox regress")
    outcomes = [_add(suite, report, task) for task in report.tasks]
    for attribute, outcome in (
        ("tests", None),
        ("failures", "failure"),
        ("errors", "error"),
        ("skipped", "skipped"),
    ):
        suite.set(attribute, str(len(outcomes) if outcome is None else outcomes.count(outcome)))
    suites = ElementTree.Element("testsuites")
    suites.append(suite)
    ElementTree.indent(suites)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, "unicode") + "\n"
    )


def save_junit(report: Report, path: Path) -> None:
    """Writes the file.

    Raises:
        InputError: It cannot be written.
    """
    write_whole(path, junit(report), "--junit")


def _add(suite: ElementTree.Element, report: Report, task: TaskResult) -> str | None:
    """Adds a task's test; returns the tag of its outcome, None if it passed."""
    case = ElementTree.SubElement(
        suite, "testcase", classname="sandbox.regress", name=_text(task.name)
    )
    properties = ElementTree.SubElement(case, "properties")
    for name, value in task.as_json().items():
        if isinstance(value, list):
            value = ",".join(map(str, value))
        if value not in (None, ""):
            ElementTree.SubElement(properties, "property", name=name, value=_text(str(value)))
    broken = [r for r in report.reasons if r.startswith(f"{task.name}: ")]
    crashed = task.crashed if report.crashes.too_many else []
    outcome = None
    if not report.complete:
        outcome = "skipped"
        ElementTree.SubElement(case, outcome, message="the run broke off: nothing is judged")
    elif broken or crashed:
        outcome = "error" if crashed else "failure"
        said = [f"seed {t['seed']} crashed: {t['reason']}" for t in crashed] + broken
        wrong = ElementTree.SubElement(case, outcome, message=_text("; ".join(said)))
        again = [report.command(t) for t in crashed]
        wrong.text = _text("\n".join([*said, *again]))
    ElementTree.SubElement(case, "system-out").text = _text(_failed(report, task))
    return outcome


def _failed(report: Report, task: TaskResult) -> str:
    lines = [f"{task.successes} of {counted(task.n, 'trial')} succeeded"]
    lines += [
        f"seed {t['seed']}: {t['status']}, {t['reason']}\n  {report.command(t)}"
        for t in task.failed
    ]
    return "\n".join(lines)


def _text(text: str) -> str:
    return _ILLEGAL.sub("�", text)
