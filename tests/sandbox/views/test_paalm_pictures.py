"""The paper's pictures of a hand, in memory, on a page and in a file."""

from __future__ import annotations

import io
import urllib.error
import urllib.request
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from models.errors import DeviceError
from sandbox.cli.main import main
from sandbox.devices.leap.leap_write import write_take
from sandbox.views.paalm.paalm_pictures import PicturePage
from sandbox.views.paalm.picture import HandMemory, PaalmPicture, ball_radius, diagram
from tests.sandbox.views.paalm_seen import colours, seen
from tests.support.leap_hands import take

SIZE = (800, 800)


def test_a_finger_that_vanishes_stays_in_the_palm_and_is_dimmed() -> None:
    frame, result = seen()
    memory = HandMemory()
    hands = memory.update(frame, result.hands)
    assert colours(diagram(hands, SIZE, 62.0, -38.0)) == {0, 1, 2, 3, 4}
    before = hands[0].fingers
    hand = result.hands["right"]
    gone = replace(hand, ids=hand.ids | {"ring": None}, held=frozenset({"ring"}))
    after = memory.update(frame, {"right": gone})
    assert not after[0].fingers[3].seen and after[0].fingers[2].seen
    assert np.allclose(after[0].fingers[3].tip, before[3].tip)
    assert colours(diagram(after, SIZE, 62.0, -38.0)) == {0, 1, 2, 4}


def test_the_ball_goes_through_palm_and_fingertips() -> None:
    rng = np.random.default_rng(0)
    around = rng.normal(size=(4, 3))
    tips = 0.05 * around / np.linalg.norm(around, axis=1, keepdims=True)
    palm, normal = np.array([0.0, 0.0, 0.05]), np.array([0.0, 0.0, -1.0])
    assert ball_radius(palm, normal, list(tips)) == pytest.approx(0.05)
    assert ball_radius(palm, normal, [np.array([0.1, 0.0, 0.06])] * 5) is None


@pytest.mark.needs("opengl")
@pytest.mark.parametrize("side", ["right", "left"])
def test_the_whole_picture_has_the_size_and_both_halves(side: str) -> None:
    frame, result = seen(side)
    with PaalmPicture((side,)) as picture:
        drawn = picture.draw(frame, result)
        assert drawn.size == (1100, 620)
        assert colours(drawn.crop((0, 0, 550, 460))) == {0, 1, 2, 3, 4}
        halves = [np.asarray(drawn.crop((x, 50, x + 550, 460)), float).std() for x in (0, 550)]
        assert min(halves) > 5.0
        picture.resize((500, 400))
        assert picture.draw(frame, result).size == (500, 400)


def test_a_page_shows_the_newest_picture_to_this_machine_only() -> None:
    with PicturePage("a hand") as page:
        page.show(Image.new("RGB", (40, 30), (255, 0, 0)))
        assert b"<img" in urllib.request.urlopen(page.url, timeout=5).read()
        with urllib.request.urlopen(page.url + "pictures", timeout=5) as stream:
            head = stream.readline() + stream.readline()
            assert b"image/jpeg" in head
            length = int(stream.readline().split(b":")[1])
            stream.readline()
            assert Image.open(io.BytesIO(stream.read(length))).size == (40, 30)
        asked = urllib.request.Request(page.url, headers={"Host": "elsewhere.example"})
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(asked, timeout=5)
        assert refused.value.code == 403
        taken = int(page.url.rstrip("/").rpartition(":")[2])
        for port in (taken, 99_999):
            with pytest.raises(DeviceError):
                PicturePage("another", port)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("paalm") / "hand.json"
    write_take(take(0), path, {"seed": 0})
    return path


@pytest.mark.needs("opengl")
def test_the_command_writes_a_picture(file: Path, tmp_path: Path) -> None:
    out = tmp_path / "hand.png"
    assert main(["paalm", "show", str(file), "--picture", str(out), "--seconds", "0.3"]) == 0
    assert Image.open(out).size == (1100, 620)
