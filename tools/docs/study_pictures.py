"""Takes a picture of a study's page for docs/studies.md.

    python -m tools.docs.study_pictures [FILE]

It shows a questionnaire that is half filled in, and a trial of a simulated user, on a page in a
real Chromium, which has to be installed. No person took part.
"""

from __future__ import annotations

import io
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image

from sandbox.session.messages import Snapshot
from tests.sandbox.study import study_on_page
from tests.sandbox.study.study_on_page import SMALL, OnPage, on_page, play, study_in
from tests.support.chromium import Browser, Tab

OUT = Path("docs/pictures/study.webp")
WIDTH, HEIGHT, PPI = 1024, 768, 132.0
SHOWN = 0.6
"""Factor on the size of both pictures, which are side by side."""
ON_THE_WAY = 4.0
"""Time (s) of the trial after which its picture is taken."""

DESIGN = SMALL.replace('"9.0x6.0in"', '"ipad2"').replace("practice = 1", "practice = 0")
FORM = """[[questionnaires]]
name = "nasa-tlx-raw"
use = "nasa-tlx-raw"
at = "start"
[[questionnaires]]"""


def main(out: Path = OUT) -> None:
    """Takes both pictures and writes them side by side."""
    study_on_page.WIDTH, study_on_page.HEIGHT, study_on_page.PPI = WIDTH, HEIGHT, PPI
    known = {
        f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1": str(PPI),
        "hand-sandbox:advised": "yes",
    }
    with tempfile.TemporaryDirectory() as folder:
        study = study_in(Path(folder), DESIGN.replace("[[questionnaires]]", FORM, 1))
        person = study.add(hand="right", hand_size=1.0, language="en")
        browser = Browser(Path(folder))
        try:
            with on_page(study, person) as running:
                tab = browser.open(running.server.url, width=WIDTH, height=HEIGHT, storage=known)
                pictures = [form(running, tab), trial(running, tab)]
        finally:
            browser.close()
    size = round(WIDTH * SHOWN), round(HEIGHT * SHOWN)
    both = Image.new("RGB", (2 * size[0] + 12, size[1]), "white")
    for i, picture in enumerate(pictures):
        small = (
            Image.open(io.BytesIO(picture)).convert("RGB").resize(size, Image.Resampling.LANCZOS)
        )
        both.paste(small, (i * (size[0] + 12), 0))
    both.save(out, quality=80, method=6)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


def sees(tab: Tab, kind: str) -> None:
    tab.wait(f"document.querySelector('.study').dataset.kind === {kind!r}")


def form(running: OnPage, tab: Tab) -> bytes:
    """Takes the picture of a questionnaire with answers to two of its items, and then skips it."""
    sees(tab, "consent")
    tab.tap("I agree")
    running.heard("form demographics")
    running.type("s")
    sees(tab, "text")
    tab.tap("Next")
    tab.wait("document.querySelectorAll('.track').length > 1")
    for i, share in enumerate((0.65, 0.2)):
        left, top, width, height = tab.evaluate(
            f"(() => {{ const b = document.querySelectorAll('.track')[{i}].getBoundingClientRect();"
            "return [b.left, b.top, b.width, b.height] })()"
        )
        tab.touch([(1, left + share * width, top + height / 2)])
        tab.touch([])
    time.sleep(0.5)
    picture = tab.picture()
    running.type("s")
    return picture


def trial(running: OnPage, tab: Tab) -> bytes:
    """Takes the picture of a trial, `ON_THE_WAY` after its start."""
    sees(tab, "task")
    tab.tap("Next")
    sees(tab, "none")
    time.sleep(1.0)
    pictures: list[bytes] = []

    def taken(snapshot: Snapshot) -> bool:
        if snapshot.time > ON_THE_WAY:
            pictures.append(tab.picture())
        return bool(pictures)

    play(running, tab, taken)
    return pictures[0]


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
