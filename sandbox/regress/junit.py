"""The report as JUnit's XML, which CI servers draw: one test for every task and crashed trial."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from models.messages.wording import counted
from sandbox.regress.baseline import write_whole
from sandbox.regress.report import Report, TaskResult

_ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 cannot hold, not even escaped."""


def junit(report: Report) -> str:
    """XML with a test for every task and for every trial that crashed.

    A task's output names failed seeds and how to see them again. A crashed trial is an error, or
    skipped where it is allowed.
    """
    suite = ElementTree.Element("testsuite", name="sandbox regress")
    failures = 0
    for task in report.tasks:
        case = ElementTree.SubElement(
            suite, "testcase", classname="sandbox.regress", name=_text(task.name)
        )
        properties = ElementTree.SubElement(case, "properties")
        for name, value in task.as_json().items():
            ElementTree.SubElement(properties, "property", name=name, value=_text(str(value)))
        broken = [r for r in report.reasons if r.startswith(f"{task.name}: ")]
        if broken:
            failures += 1
            failure = ElementTree.SubElement(case, "failure", message=_text("; ".join(broken)))
            failure.text = _text("\n".join(broken))
        if not report.complete:
            ElementTree.SubElement(case, "skipped", message="the run broke off: nothing is judged")
        ElementTree.SubElement(case, "system-out").text = _text(_failed(report, task))
    crashes = report.crashes
    for trial in crashes.trials:
        name = f"{trial['task']} seed {trial['seed']}"
        case = ElementTree.SubElement(
            suite, "testcase", classname="sandbox.regress.crashed", name=_text(name)
        )
        if crashes.too_many:
            error = ElementTree.SubElement(case, "error", message=_text(trial["reason"]))
            error.text = _text(report.command(trial))
        else:
            allowed = f"--allow-crashes {crashes.allowed}: {trial['reason']}"
            ElementTree.SubElement(case, "skipped", message=_text(allowed))
    crashed = len(crashes.trials)
    skipped = (0 if report.complete else len(report.tasks)) + crashed * (not crashes.too_many)
    suite.set("tests", str(len(report.tasks) + crashed))
    suite.set("failures", str(failures))
    suite.set("errors", str(crashed if crashes.too_many else 0))
    suite.set("skipped", str(skipped))
    suites = ElementTree.Element("testsuites")
    suites.append(suite)
    ElementTree.indent(suites)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, "unicode") + "\n"
    )


def save_junit(report: Report, path: Path) -> None:
    """Writes the ElementTree.

    Raises:
        InputError: It cannot be written.
    """
    write_whole(path, junit(report), "--junit")


def _failed(report: Report, task: TaskResult) -> str:
    lines = [f"{task.successes} of {counted(task.n, 'trial')} succeeded"]
    lines += [
        f"seed {t['seed']}: {t['status']}, {t['reason']}\n  {report.command(t)}"
        for t in task.failed
    ]
    return "\n".join(lines)


def _text(text: str) -> str:
    return _ILLEGAL.sub("�", text)
