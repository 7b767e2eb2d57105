"""Takes the README's picture of the web page.

    python -m tools.docs.page_picture

The fingers of a simulated user touch the page in a real Chromium, which has to be installed. The
picture is taken when the box is nearly at its goal.
"""

from __future__ import annotations

import argparse
import io
import tempfile
from pathlib import Path

from PIL import Image

from models.surface import METRES_PER_INCH
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.server.page_frames import describe_scene, pack_skin
from sandbox.server.page_server import PageServer
from sandbox.server.web import WebDevice
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from tasks.user import UserConfiguration
from tests.support.chromium import Browser, Tab

OUT = Path("docs/pictures/page.webp")
WIDTH, HEIGHT, PPI = 1024, 768, 132.0
SEED, FINGERS, FEWEST = 3, 5, 3
"""Seed, number of the user's fingers, and least number of touching fingers in the picture. Only as
many fingers touch as the face of the box has room for."""
NEARLY = 0.7
"""Progress of the trial after which the picture is taken."""


def main() -> None:
    """Plays, takes the picture and writes it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=OUT, help="picture")
    out = parser.parse_args().out
    server = PageServer()
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(Path(folder))
        try:
            key = f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1"
            known = {key: str(PPI), "hand-sandbox:hint-closed:box-to-goal": "yes"}
            tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=known)
            picture = play(server, tab)
        finally:
            browser.close()
            server.close()
    Image.open(io.BytesIO(picture)).convert("RGB").save(out, quality=80, method=6)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


def play(server: PageServer, tab: Tab) -> bytes:
    """The picture, as PNG."""
    session = build(
        Settings(seed=SEED).changed(size_in=(WIDTH / PPI, HEIGHT / PPI)),
        (lambda task, surface: WebDevice(surface),),
    )
    device, surface = session.rigs[0].device, session.rigs[0].reconstructor.surface
    assert isinstance(device, WebDevice)
    message = describe_scene(1, session.scene, session.task, surface, "right", "")
    server.show_scene(
        message, session.scene, device, [pack_skin(h) for h in session.scene.spec.hands]
    )
    tab.wait("!!document.querySelector('.task').textContent")
    user = SimulatedDevice(session.task, UserConfiguration(fingers=FINGERS), surface, SEED)
    last: list[tuple[int, float, float]] = []
    scale = PPI / METRES_PER_INCH
    while not session.over:
        snapshot = session.advance()
        user.show(snapshot)
        server.publish(snapshot)
        wanted = [(c.id, c.x * scale, c.y * scale) for c in user.poll(snapshot.time)[-1].contacts]
        others = [i for i, _, _ in wanted] != [i for i, _, _ in last]
        moved = wanted != last and session.step % (3 * session.scene.substeps) == 0
        if others or moved:
            tab.touch(wanted)
            device.frame_ready.wait(5.0)
            last = wanted
        held = len(wanted) >= FEWEST and snapshot.hands[0].solid
        if snapshot.score.progress > NEARLY and held:
            clock = f"{snapshot.time:.1f} "
            tab.wait(f"document.querySelector('.clock').textContent.startsWith('{clock}')")
            return tab.picture()
    raise SystemExit(f"the user did not get there: {session.scorer.score.reason}")


if __name__ == "__main__":
    main()
