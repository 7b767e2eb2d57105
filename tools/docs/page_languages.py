"""Takes pictures of the page in every language and on several screens.

    python -m tools.docs.page_languages FOLDER [--languages en,ar] [--sizes 1180x820]

Opens the page in a real Chromium, which has to be installed, shows its dialogs and states, and
prints every text that is wider than its element or outside of the screen. `--sheet` also writes two
sheets of pictures: `docs/pictures/languages.webp` with every language, and
`docs/pictures/screens.webp` with every screen. The shown states are prepared: no person plays, and
no physics runs. Chinese and Japanese need fonts such as Debian's fonts-noto-cjk.
"""

from __future__ import annotations

import argparse
import io
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from PIL import Image

from models.surface import Surface
from sandbox.play.page_play import OTHER_PAGE
from sandbox.play.pages import EASIEST_FIRST
from sandbox.server.page_frames import describe_scene, pack_skin
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import (
    LIFT_STRIP_PX,
    Choice,
    ItemView,
    PageScreen,
    Sheet,
    StudyView,
    TaskName,
)
from sandbox.server.screen import explain_refusal, scaled
from sandbox.server.web import WebDevice
from sandbox.session.collision_gating import STUCK
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from sandbox.words import LANGUAGES, words_in
from tasks.registry import TASKS
from tasks.score import Status
from tests.support.chromium import Browser, Tab
from tests.support.processes import PATIENCE
from tests.support.viewed import contact_at, with_load

SIZES = ("390x844", "820x1180", "1180x820", "1366x1024", "1280x800", "3840x2160")
USUAL = "1180x820"
PPI = 132.0
SMALLEST_IN = (7.76, 5.82)
"""Least size (inches) of the touch rectangle. Smaller screens show a part of it."""
SHEET = Path("docs/pictures/languages.webp")
SHOWN = ("start", "tasks", "done")
"""Names of the pictures of every language on the sheet."""
TILE = (472, 328)
"""Size (px) of a picture on the sheet."""
SCREENS = Path("docs/pictures/screens.webp")
ON_SCREENS = ("start", "grip", "inside", "done", "lost", "tasks")
"""Names of the pictures on the sheet of screens, in English and Arabic."""
SMALL_TILE = (236, 164)
"""Largest size (px) of a picture on this sheet. Screens have different proportions."""
WITH_MICE = ("1280x800", "3840x2160")
"""Screens on which the start is also shown for people with a mouse."""
FOOTER_PX = 66.0
"""Height (CSS px) of the buttons below the table on an upright phone."""
START = 60.0
"""Longest time (s) until a page joins."""

GRIP = (
    (13.0, 30.0, 0.0, 0.0, 0.0),
    (13.0, 13.0, 0.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0, 0.0),
)
"""Arguments of `with_load` for a grip of 13 N in which the index finger is at its force limit."""

OVERFLOWS = """
(() => {
  const wrong = [];
  for (const element of document.body.querySelectorAll("*")) {
    const own = [...element.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    if (!own || !element.checkVisibility() || element.closest("script, noscript, .voice")) continue;
    const range = document.createRange();
    range.selectNodeContents(element);
    const box = range.getBoundingClientRect();
    const scrolls = element.closest(".veil, .study");
    const outside = box.left < -1 || box.right > innerWidth + 1 ||
      (!scrolls && (box.top < -1 || box.bottom > innerHeight + 1));
    const place = element.getBoundingClientRect();
    const spills = box.width > place.width + 1.5 || box.height > 1.3 * place.height + 6;
    if (outside || spills)
      wrong.push(`${element.className || element.tagName}: ${element.textContent.slice(0, 60)}`);
  }
  return wrong;
})()
"""


def main() -> None:
    """Takes the pictures, prints texts that overflow, and makes the sheets."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="folder for the pictures")
    parser.add_argument("--languages", default=",".join(LANGUAGES))
    parser.add_argument(
        "--sizes", default="", help="such as 1180x820; default: all screens for en and ar"
    )
    parser.add_argument("--sheet", action="store_true", help=f"also writes {SHEET} and {SCREENS}")
    options = parser.parse_args()
    if without_font := [code for code in options.languages.split(",") if not has_font(code)]:
        parser.error(
            f"no font for {', '.join(without_font)}; install fonts-noto-cjk (zh, ja) or "
            "fonts-noto-core (all others), and fontconfig"
        )
    options.folder.mkdir(parents=True, exist_ok=True)
    taken = wrong = 0
    with tempfile.TemporaryDirectory() as profile:
        browser = Browser(Path(profile))
        try:
            for code in options.languages.split(","):
                everywhere = SIZES if code in ("en", "ar") else (USUAL,)
                sizes = options.sizes.split(",") if options.sizes else everywhere
                for size in sizes:
                    for name, tab in moments(browser, code, size):
                        path = options.folder / f"{code}-{size}-{name}.png"
                        path.write_bytes(tab.picture())
                        overflows = tab.evaluate(OVERFLOWS)
                        taken, wrong = taken + 1, wrong + len(overflows)
                        for line in overflows:
                            print(f"{code} {size} {name}: {line}", flush=True)
        finally:
            browser.close()
    print(f"{taken} pictures, {wrong} texts outside of their places")
    if options.sheet:
        sheet(options.folder)
        sheet_of_screens(options.folder)


def has_font(code: str) -> bool:
    """True if this machine has a font with the letters of a language, as fontconfig lists them."""
    if shutil.which("fc-list") is None:
        return False
    listed = subprocess.run(["fc-list", f":lang={code}", "family"], capture_output=True, check=True)
    return bool(listed.stdout.strip())


def moments(browser: Browser, code: str, size: str) -> Iterator[tuple[str, Tab]]:
    """Shows all states of the page in a language on a screen, one after the other; yields their
    names."""
    yield from in_play(browser, code, size)
    yield from in_study(browser, code, size)


def in_play(browser: Browser, code: str, size: str) -> Iterator[tuple[str, Tab]]:
    """Shows the states of the page in play."""
    width, height = (int(side) for side in size.split("x"))
    words = words_in(code)
    tasks = [TaskName(name, "", TASKS[name].lift_range > 0) for name in EASIEST_FIRST]
    server = PageServer(tasks=tasks)
    known = {
        f"hand-sandbox:px-per-inch:{min(width, height)}x{max(width, height)}@1": str(PPI),
        "hand-sandbox:quality": "3",
        "hand-sandbox:best:box-to-goal": "7.25",
    }
    try:
        session = show(server, width, height)
        tab = browser.open(f"{server.url}&lang={code}", width=width, height=height, storage=known)
        assert server.wait_for_player(START) and server.screen is not None
        middle = middle_of_table(server.screen, width, height)
        if server.screen.fit == "phone":
            session = show(server, width, height, scaled(server.screen, lifts=True))
        tab.wait("!!document.querySelector('.dot[data-condition=open]')")
        snapshot = session.advance()
        # One frame after the other, as in play.
        until = time.monotonic() + START
        while not tab.evaluate("document.querySelector('.preparing').hidden"):
            assert time.monotonic() < until, f"the page shows no table; {tab.text()}"
            server.publish(snapshot, "start")
            time.sleep(0.05)
        yield settled("start", tab)
        tab.tap(words["tasks"])
        yield settled("tasks", tab)
        tab.tap(words["close"])
        tab.tap(words["settings"])
        yield settled("settings", tab)
        tab.tap(words["language"])
        yield settled("languages", tab)
        tab.tap(words["close"])
        tab.tap(words["settings"])
        tab.tap(words["measure_screen"])
        yield settled("card", tab)
        tab.tap(words["card_skip"])
        tab.touch([(1, middle[0] - 60, middle[1]), (2, middle[0] + 60, middle[1] + 20)])
        held = with_fingers(session, snapshot)
        server.publish(with_load(held, *GRIP))
        yield settled("grip", tab)
        server.publish(held.with_hands(replace(held.hands[0], inside=frozenset({1}))))
        yield settled("inside", tab)
        server.publish(replace(snapshot, notices=(STUCK,)))
        tab.wait("!document.querySelector('.toast').hidden")
        yield settled("notice", tab)
        tab.touch([])
        score = replace(snapshot.score, held=True, final=True, progress=1.0, status=Status.HELD)
        server.publish(replace(snapshot, score=score))
        tab.wait("!document.querySelector('.end').hidden")
        yield settled("done", tab)
        score = replace(snapshot.score, status=Status.FAILED)
        server.publish(replace(snapshot, score=score))
        tab.wait("!document.querySelector('.end').classList.contains('success')")
        yield settled("over", tab)
        surface = Surface(5.4, 2.5)
        settings = Settings(task="stack").changed(size_in=(surface.width_in, surface.height_in))
        server.show_problem(OTHER_PAGE, *refusal(settings))
        tab.wait("!document.querySelector('.trouble').hidden")
        yield settled("trouble", tab)
        server.close()
        tab.wait("!document.querySelector('.curtain').hidden")
        yield settled("lost", tab)
        tab.close()
        if size in WITH_MICE:
            yield from with_a_mouse(browser, code, width, height)
    finally:
        server.close()


def middle_of_table(screen: PageScreen, width: int, height: int) -> tuple[float, float]:
    """Middle (px) of the part of the page that shows the table. On a phone, this part is right of
    the texts, or between texts and buttons."""
    below = FOOTER_PX if screen.height_px < height else 0.0
    return width - screen.width_px / 2, height - below - screen.height_px / 2


def with_a_mouse(browser: Browser, code: str, width: int, height: int) -> Iterator[tuple[str, Tab]]:
    """Shows the start for a person with a mouse. The table fills the window."""
    server = PageServer()
    try:
        screen = PageScreen(PPI, width, height, False, "mouse")
        session = show(server, width, height, scaled(screen, lifts=True))
        tab = browser.open("about:blank", width=width, height=height)
        tab.call("Emulation.setTouchEmulationEnabled", enabled=False)
        tab.go(f"{server.url}&lang={code}")
        tab.wait("!!document.querySelector('.task')?.textContent")
        server.publish(session.advance(), "start")
        tab.wait("document.querySelector('.preparing').hidden")
        yield settled("mouse", tab)
        tab.close()
    finally:
        server.close()


def with_fingers(session: Session, snapshot: Snapshot) -> Snapshot:
    """The page's two fingers as thumb and index of a solid hand."""
    device = session.rigs[0].device
    assert isinstance(device, WebDevice)
    ids: list[int] = []
    until = time.monotonic() + PATIENCE
    while len(ids) < 2:
        assert time.monotonic() < until, "the fingers never came"
        ids = [c.id for frame in device.poll() for c in frame.contacts][-2:]
    hand = snapshot.hands[0]
    contacts = tuple(
        contact_at(hand.surface, i, hand.tips[k], k, "active") for k, i in enumerate(sorted(ids))
    )
    return snapshot.with_hands(replace(hand, contacts=contacts, solid=frozenset({0, 1})))


def refusal(settings: Settings) -> list[str]:
    """Text and values of the message for a screen that is too small."""
    from models.errors import SurfaceTooSmallError

    size = settings.surface.size_in
    error = SurfaceTooSmallError(settings.task, size, "the boxes", SMALLEST_IN)
    return list(explain_refusal(error, settings, LIFT_STRIP_PX / PPI))


def show(
    server: PageServer, width: int, height: int, fitted: dict[str, Any] | None = None
) -> Session:
    """Shows a table with the lift control on the page. Without `fitted` settings it has its true
    size."""
    size = (width - LIFT_STRIP_PX) / PPI, height / PPI
    size = max(size[0], SMALLEST_IN[0]), max(size[1], SMALLEST_IN[1])
    settings = fitted or {"size_in": (min(size[0], 10.3), min(size[1], 7.7))}
    session = build(
        Settings(task="stack").changed(**settings),
        (lambda task, surface: WebDevice(surface),),
    )
    device, surface = session.rigs[0].device, session.rigs[0].reconstructor.surface
    assert isinstance(device, WebDevice)
    scored = bool(settings.get("scored", True))
    number = server.next_scene()
    message = describe_scene(
        number, session.scene, session.task, surface, "right", "", scored=scored
    )
    server.show_scene(
        message, session.scene, device, [pack_skin(h) for h in session.scene.spec.hands]
    )
    return session


def in_study(browser: Browser, code: str, size: str) -> Iterator[tuple[str, Tab]]:
    """Shows the states of the page in a study. The questions of the forms are texts of the page."""
    width, height = (int(side) for side in size.split("x"))
    words = words_in(code)
    text, ask, low, high = (
        words[key] for key in ("gestures_ipad", "card_title", "card_smaller", "card_larger")
    )
    items = [
        ItemView("a", "scale", ask, False, [], 0.0, 100.0, 5.0, low, high),
        ItemView("b", "scale", ask, False, [], 1.0, 7.0, 1.0, low, high),
        ItemView("c", "number", ask, True, [], 18.0, 100.0, 1.0, "", ""),
        ItemView("d", "choice", ask, False, [Choice("l", low), Choice("h", high)], 0, 1, 1, "", ""),
        ItemView("e", "text", ask, True, [], 0.0, 1.0, 1.0, "", ""),
    ]
    note = words["wording_translation"]
    sheets = {
        "consent": Sheet(1, "consent", "", text, [], {}, 0.0),
        "form": Sheet(2, "form", ask, "", items, {"a": 20.0, "b": 2.0}, 0.0, note),
        "rest": Sheet(3, "rest", words["rest"], words["rest_over"], [], {}, 90.0),
        "end": Sheet(4, "end", "", words["end"], [], {}, 0.0),
    }
    server = PageServer(study=StudyView(code, {}, ["task", "goal"]))
    try:
        known = {
            f"hand-sandbox:px-per-inch:{min(width, height)}x{max(width, height)}@1": str(PPI),
            "hand-sandbox:advised": "yes",
        }
        tab = browser.open(server.url, width=width, height=height, storage=known)
        for name, one in sheets.items():
            server.show_sheet(one)
            tab.wait(f"document.querySelector('.study').dataset.kind === {one.kind!r}")
            yield settled(f"study_{name}", tab)
        tab.close()
    finally:
        server.close()


def settled(name: str, tab: Tab) -> tuple[str, Tab]:
    """Waits until the current state of the page is drawn."""
    tab.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return name, tab


def sheet(folder: Path) -> None:
    """Makes a picture with one row for each language."""
    whole = Image.new("RGB", (TILE[0] * len(SHOWN), TILE[1] * len(LANGUAGES)))
    for row, code in enumerate(LANGUAGES):
        for column, name in enumerate(SHOWN):
            data = (folder / f"{code}-{USUAL}-{name}.png").read_bytes()
            tile = (
                Image.open(io.BytesIO(data)).convert("RGB").resize(TILE, Image.Resampling.LANCZOS)
            )
            whole.paste(
                tile.resize(TILE, Image.Resampling.LANCZOS), (TILE[0] * column, TILE[1] * row)
            )
    whole.save(SHEET, quality=72, method=6)
    print(f"{SHEET}: {SHEET.stat().st_size / 1000:.0f} kB")


def sheet_of_screens(folder: Path) -> None:
    """Makes a picture with one row for each screen, first in English and then in Arabic."""
    rows = [(code, size) for code in ("en", "ar") for size in SIZES]
    across, down = SMALL_TILE
    whole = Image.new("RGB", (across * len(ON_SCREENS), down * len(rows)))
    for row, (code, size) in enumerate(rows):
        for column, name in enumerate(ON_SCREENS):
            with Image.open(folder / f"{code}-{size}-{name}.png") as picture:
                tile = picture.convert("RGB")
            tile.thumbnail((across - 4, down - 4), Image.Resampling.LANCZOS)
            left = across * column + (across - tile.width) // 2
            whole.paste(tile, (left, down * row + (down - tile.height) // 2))
    whole.save(SCREENS, quality=70, method=6)
    print(f"{SCREENS}: {SCREENS.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
