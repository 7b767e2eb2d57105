"""Reports of few people, printed by a real browser."""

from __future__ import annotations

import base64
import os
import re
from pathlib import Path

import pytest

from sandbox.study.tables.column import csv_bytes
from tests.sandbox.study.report.study_reports import planted, report
from tests.support.chromium import BINARY, Browser
from tests.support.planted_study import Truth

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

SCALES = ("workload", "mental", "physical", "temporal", "performance", "effort", "frustration")


@pytest.mark.parametrize(("people", "pages"), [(1, 5), (3, 8)])
def test_the_report_of_few_people_fits_few_pages(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, people: int, pages: int
) -> None:
    planted(tmp_path, Truth(people=people, repetitions=3))
    scores = [
        {
            "ppid": ppid,
            "instrument": "nasa-tlx-raw",
            "scale": scale,
            "factor_encoder": level,
            "score": 10 * i,
        }
        for ppid in (f"P{n:03d}" for n in range(1, people + 1))
        for scale in SCALES
        for i, level in enumerate(("a", "b", "c"))
    ]
    (tmp_path / "tables/scores.csv").write_bytes(csv_bytes(scores, tuple(scores[0])))
    assert "nasa-tlx-raw: mental" in report(tmp_path).text
    browser = Browser(tmp_path_factory.mktemp("chromium"))
    try:
        tab = browser.open((tmp_path / "report" / "report.html").as_uri(), width=900, height=900)
        tab.wait("document.readyState === 'complete'")
        pdf = base64.b64decode(tab.call("Page.printToPDF")["data"])
    finally:
        browser.close()
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) <= pages
    assert (tmp_path / "report" / "report.html").stat().st_size <= 150_000
