"""A window that shows the frames of a hand in the air."""

from __future__ import annotations

import sys

import glfw
import numpy as np
import pytest
from PIL import Image

from sandbox.views.paalm.picture_window import PaalmWindow
from tests.sandbox.views.paalm_seen import colours, seen
from tests.support.screen import screen


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs an X server in memory")
def test_a_window_shows_the_same_and_closes_with_escape() -> None:
    frame, result = seen()
    with screen() as display:
        with PaalmWindow(("right",)) as window:
            still_open = [window.show(frame, result)]
            assert window.picture is not None
            assert colours(window.picture) == {0, 1, 2, 3, 4}
            assert colours(Image.fromarray(display.picture().astype(np.uint8))) == {0, 1, 2, 3, 4}
            display.do(lambda: still_open.append(window.rest()), "key", "--delay", 300, "Escape")
            assert still_open[0] and not all(still_open)
        glfw.terminate()
