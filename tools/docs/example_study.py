"""The example study for docs: `python -m tools.docs.example_study out/three-encoders-simulated`.

Makes the report on a simulated study, copies its page to examples/study/report.html, and writes
docs/example-study.md with some of its tables and pictures. No person took part.
"""

from __future__ import annotations

import io
import re
import shutil
import sys
import tempfile
from contextlib import redirect_stdout
from importlib.resources import files
from pathlib import Path

from sandbox.cli.main import main as sandbox
from sandbox.study.design.design_file import load_design
from sandbox.study.record.folder import StudyFolder
from sandbox.study.report.data import load_study
from sandbox.study.report.make import make_report
from sandbox.study.report.numbers import Results, results
from sandbox.study.report.page import Paragraph, Picture, Section, Table, head, sections
from sandbox.study.tables.tables import make_tables

DESIGN = "examples/study/design.toml"
PAGE = Path("examples/study/report.html")
LARGEST = 1_000_000
"""Size (bytes) below which the report's page is copied."""

TEXT = """# An example: three encoders by two tasks

**Simulated. No person took part.** The page shows the course of a study and its report. Its results
say nothing about people. The design is
[examples/study/design.toml](../examples/study/design.toml), the whole report
[examples/study/report.html](../examples/study/report.html) (save it, and open it in a browser).
`python -m tools.docs.example_study FOLDER` wrote this page and all numbers in it.

The level `paper` is the whole method of the paper. Its encoder is also a quadratic, but without the
ridge penalty of the level `quadratic`. The two levels also differ in labels, correction and
smoothing. Differences between them are effects of all four.

```console
$ sandbox study check {design}
{check}
$ sandbox study plan {design} --power
...
{plan}
$ sandbox study simulate {design} --out out --participants {people}
...
{simulated}
$ sandbox study report out/three-encoders-simulated
```

The design plans {planned} participants. For this page {people} simulated participants were
played. They differ in skill (reaction, speed, noise, aim), number of fingers, length of the hand,
and better hand: `sandbox/study/run/simulated_study.py`.
**Their answers to questionnaires are random**, and so are the differences between encoders in these
answers. The encoders learned from simulated people, too.

## Contents of the report

{facts}

{findings}

{sections}
"""


def main(folder: Path, docs: Path = Path("docs")) -> None:
    """Writes the page, its pictures and the whole report."""
    found = results(load_study(folder))
    if found.data.mode != "simulated":
        raise SystemExit("this example needs a study with simulated people only")
    with tempfile.TemporaryDirectory() as work:
        page = make_report(folder, Path(work) / "report")
        if page.stat().st_size < LARGEST:
            shutil.copyfile(page, PAGE)
    shown, counted = head(found), make_tables(StudyFolder.at(folder))
    plan = output_of("study", "plan", DESIGN, "--power").splitlines()
    text = TEXT.format(
        design=DESIGN,
        check=output_of("study", "check", DESIGN).strip(),
        plan="\n".join(line for line in plan if line[:1].isalpha()),
        simulated="out/{}: {participants} simulated participants, {trials} trials that count, "
        "{excluded} excluded".format(folder.name, **counted),
        planned=load_design(Path(DESIGN), try_out=False).participants,
        people=counted["participants"],
        facts="\n".join(f"- {name}: {value}, {more}" for name, value, more in shown["facts"]),
        findings="\n".join(f"- {finding}" for finding in shown["findings"]),
        sections="\n\n".join(shown_sections(found, docs)),
    )
    (docs / "example-study.md").write_text(text.rstrip() + "\n", encoding="utf-8")


def output_of(*command: str) -> str:
    """Runs a command, and returns the text that it prints."""
    out = io.StringIO()
    with redirect_stdout(out):
        assert sandbox(list(command)) == 0
    return out.getvalue()


NAMES = {"outcome-time-s": ("example-time", "example-solved"), "order": ("example-practice",)}
"""Section -> files of its pictures that are written."""
LEFT_OUT = ("sessions", "measures", "methods")
"""Sections that only the whole report has."""


def shown_sections(found: Results, docs: Path) -> list[str]:
    """Sections of the report as Markdown. Pictures are written to files."""
    some = [section for section in sections(found) if section.id not in LEFT_OUT]
    return [line for section in some for line in shown(section, docs)]


def shown(section: Section, docs: Path) -> list[str]:
    """Lines of a section in Markdown. Pictures without a name in `NAMES` are left out."""
    names = list(NAMES.get(section.id, ()))
    lines = [f"## {section.title}"]
    for part in section.parts:
        if isinstance(part, Paragraph):
            lines.append(part.text)
        elif isinstance(part, Table):
            lines.append(markdown(part))
        elif isinstance(part, Picture):
            for name, (svg, caption) in zip(names, part.pictures, strict=False):
                (docs / "pictures" / f"{name}.svg").write_text(alone(svg), encoding="utf-8")
                lines.append(f"![{caption}](pictures/{name}.svg)\n\n*{caption}*")
            lines += map(markdown, part.tables)
    return lines


def markdown(table: Table) -> str:
    """A table of the report in Markdown."""
    rows = [list(table.head), ["---"] * len(table.head), *map(list, table.rows)]
    lines = "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in r) + " |" for r in rows
    )
    return f"{table.caption}:\n\n{lines}" + (f"\n\n{table.note}" if table.note else "")


def alone(svg: str) -> str:
    """A picture of the report as a separate SVG file, with the light colours of the page."""
    css = files("sandbox.study.report").joinpath("page.css").read_text(encoding="utf-8")
    light = dict(re.findall(r"(--\w+): (#\w+)", css.split("@media")[0]))
    svg = re.sub(r"var\((--\w+)\)", lambda m: light[m[1]], svg)
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg)
    assert size
    start = f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[1]}" height="{size[2]}" '
    svg = svg.replace("<svg ", start + 'font-family="sans-serif" ', 1)
    return svg.replace(">", f'>\n<rect width="100%" height="100%" fill="{light["--paper"]}"/>', 1)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
