"""Draws pictures of the tasks for the page's menu, from trials of the simulated user.

    python -m tools.docs.task_pictures    # draws all of them again

Needs OpenGL. The build of the page copies the pictures.
"""

from __future__ import annotations

from pathlib import Path

from PIL import Image

from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import View, open_trial
from sandbox.trial.settings import Settings
from sandbox.views.renderer import Renderer
from tasks.registry import TASKS, hands_of

FOLDER = Path(__file__).resolve().parents[2] / "sandbox" / "views" / "page" / "src" / "pictures"
SIZE = (240, 135)
"""Size (px) of a picture. It is drawn at twice this size."""
QUALITY = 55
"""Quality of WebP, 0 to 100."""
MOMENT = 0.3
"""Time of the picture, as a share of the time until the trial's success."""


def draw(task: str) -> Image.Image:
    """The table of a task while its simulated user plays, without texts.

    Raises:
        GraphicsError: This machine has no OpenGL.
    """
    snapshots: list[Snapshot] = []

    def make_views(session: Session) -> list[View]:
        return [snapshots.append]

    with open_trial(Settings(task=task), make_views=make_views) as trial:
        session = trial.session
        trial.run(stop=lambda: session.scorer.score.held)
        size = (2 * SIZE[0], 2 * SIZE[1])
        with Renderer(session.scene, session.whole_surface, size) as renderer:
            return renderer.without_texts(snapshots[int(MOMENT * len(snapshots))])


def main() -> None:
    """Draws the pictures of all tasks that the page offers."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, kind in TASKS.items():
        if hands_of(kind) > 1:
            continue
        path = FOLDER / f"{name}.webp"
        draw(name).resize(SIZE, Image.Resampling.LANCZOS).save(path, quality=QUALITY, method=6)
        print(f"{path.name}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
