"""Pictures as a stream into the camera's page, each as soon as the page is ready for it.

Chromium's page asks for a camera and gets a canvas, on which pictures are drawn. The real engine
finds hands in them as it does for a person. Time is stretched: a picture waits until the one before
it was seen, however long that takes on this machine.
"""

from __future__ import annotations

import base64
import json
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

from models.frames import LandmarkFrame
from sandbox.devices.webcam.landmark_server import LandmarkServer
from sandbox.devices.webcam.landmarks_json import PictureMessage, frame_of, picture_message
from sandbox.session.closeable import Closeable
from tests.support.chromium import Browser

SIZE = (640, 480)
"""px of the pictures."""

_CAMERA = """
(() => {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [WIDTH, HEIGHT];
  const pen = canvas.getContext("2d");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  let seen = null, count = 0, wanted = 0;
  const track = new MediaStreamTrackGenerator({ kind: "video" });
  const writer = track.writable.getWriter();
  const show = () => writer.write(new VideoFrame(canvas, { timestamp: 1000 * performance.now() }));
  navigator.mediaDevices.getUserMedia = async () => {
    const first = setInterval(() => (window.lookedAt() ? clearInterval(first) : show()), 500);
    return new MediaStream([track]);
  };
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (text) {
    if (text.includes('"seen"')) {
      count++;
      if (count > wanted && seen) { seen(text); seen = null; }
    }
    send.call(this, text);
  };
  window.lookedAt = () => count;
  window.look = async (jpeg) => {
    const picture = new Image();
    picture.src = "data:image/jpeg;base64," + jpeg;
    await picture.decode();
    pen.drawImage(picture, 0, 0);
    wanted = count;
    const answer = new Promise((resolve) => { seen = resolve; });
    show();
    // A frame may be lost where the browser is busy.
    const again = setInterval(show, 1000);
    const text = await answer;
    clearInterval(again);
    return text;
  };
})();
""".replace("WIDTH, HEIGHT", f"{SIZE[0]}, {SIZE[1]}")


class PictureStream(Closeable):
    """The camera's page in Chromium, without a camera.

    Args:
        engine: Folder of the engine.
        hands: Hands that the engine looks for.

    Attributes:
        milliseconds: Time that the page took for each picture.
    """

    def __init__(self, engine: Path, hands: int = 1) -> None:
        self.milliseconds: list[float] = []
        wanted = {"sides": ["right"], "most": 2, "hands": hands, "mirrored": False}
        messages: list[PictureMessage] = []
        with ExitStack() as stack:
            self._browser = Browser(Path(stack.enter_context(TemporaryDirectory())))
            stack.callback(self._browser.close)
            self._server = LandmarkServer(engine, wanted, messages.append, lambda: None)
            stack.callback(self._server.close)
            self._tab = self._browser.open("about:blank")
            self._tab.call("Page.addScriptToEvaluateOnNewDocument", source=_CAMERA)
            self._tab.go(self._server.url)
            # The engine loads, and its first picture takes longest.
            self._tab.wait("window.lookedAt() > 0", 120.0)
            self._open = stack.pop_all()

    def look(self, jpeg: bytes, at: float) -> LandmarkFrame:
        """What the engine finds in a picture that was taken at `at`, s."""
        data = base64.b64encode(jpeg).decode()
        frame = frame_of(picture_message(self._tab.evaluate(f"window.look({json.dumps(data)})")))
        self.milliseconds.append(1000.0 * (frame.time - frame.taken))
        return LandmarkFrame(at, frame.hands, frame.size, at, frame.source)

    def close(self) -> None:
        """Ends the browser and the page's server."""
        self._open.close()
