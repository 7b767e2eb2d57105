"""Windows and films tell the force of a grip at the fingers, and where the hand has no more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from models.surface import Surface
from sandbox.session.messages import STRONGEST, TOLD, Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import open_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from sandbox.views.cameras import Lens, camera_above
from sandbox.views.drawing import Drawing
from sandbox.views.marks import ARC_SIDES
from sandbox.views.overlay import OverlayTexts, stickers
from tests.support.scripted import box_xy, pinch, run, scripted


def gripped(width: float) -> tuple[Session, Snapshot]:
    """Thumb and index finger that have closed on a box, with a distance in m between them."""
    empty = scripted(lambda now: (), seed=1)
    at = box_xy(empty)
    empty.close()
    touch = pinch(at, lambda now: 0.074 if now < 1.0 else width, yaw=0.7117)
    session = scripted(touch, seed=1)
    run(session, 1.9)
    return session, session.advance()


def drawn(session: Session, snapshot: Snapshot) -> tuple[int, list[int]]:
    """Number of geoms, and widths of the first texts, which are the names of fingers."""
    surface: Surface = session.rigs[0].reconstructor.surface
    drawing = Drawing(session.scene, surface)
    drawing.update(snapshot, camera_above(surface))
    lens = Lens.of(drawing.view, (960, 540))
    names = stickers(snapshot, lens, surface, drawing.drop, OverlayTexts())
    return drawing.view.ngeom, [s.image.width for s in names[: len(snapshot.hands[0].contacts)]]


@pytest.mark.parametrize("width", [0.062, 0.056, 0.050])
def test_an_arc_around_each_finger_closes_with_the_force_of_the_grip(width: float) -> None:
    session, snapshot = gripped(width)
    silent = replace(snapshot, see_loads=tuple)
    stored = [finger.stored for finger in snapshot.loads[0].fingers if finger.stored >= TOLD]
    geoms, names = drawn(session, snapshot)
    without, plain = drawn(session, silent)
    pieces = [max(round(force / STRONGEST * ARC_SIDES), 1) for force in stored]
    assert len(stored) == 2 and geoms - without == sum(pieces)
    assert all(told > bare for told, bare in zip(names, plain, strict=True))


def test_a_hand_without_more_force_closes_the_arc() -> None:
    # The simulated user carries the box with a weak hand.
    chosen = trial_settings(TrialOptions(task="box-to-goal", seed=4, fingers=3, impulse="safe"))
    sessions: list[Session] = []
    full: list[Snapshot] = []

    def views(session: Session) -> list[Callable[[Snapshot], None]]:
        sessions.append(session)
        return [lambda seen: full.append(seen) if seen.loads and seen.loads[0].full else None]

    with open_trial(chosen, device_makers(chosen), views) as played:
        played.run(stop=lambda: bool(full))
        fingers = full[0].loads[0].full
        geoms, _ = drawn(sessions[0], full[0])
        without, _ = drawn(sessions[0], replace(full[0], see_loads=tuple))
    others = [
        max(round(load.stored / STRONGEST * ARC_SIDES), 1)
        for label, load in enumerate(full[0].loads[0].fingers)
        if label not in fingers and load.stored >= TOLD
    ]
    assert geoms - without == len(fingers) * ARC_SIDES + sum(others)
