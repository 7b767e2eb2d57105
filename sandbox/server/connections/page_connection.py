"""A WebSocket connection that receives and sends messages without waking a task.

`recv` and `send` of `websockets` are coroutines: every received message and every sent frame waits
for one more round of the event loop. While a session occupies the processor's caches, both
together take a tenth of a millisecond.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from websockets.asyncio.server import ServerConnection
from websockets.frames import Frame, Opcode
from websockets.http11 import Request, Response
from websockets.protocol import State


class PageConnection(ServerConnection):
    """The WebSocket connection of a page; runs in the server's thread.

    Attributes:
        hear: Called with every text message that arrives in one frame. Other messages, and all
            messages while it is None, are received by `recv`.
    """

    hear: Callable[[str], None] | None = None

    def process_event(self, event: Request | Response | Frame) -> None:
        """Processes an event that the library has parsed."""
        text = None
        if self.hear and isinstance(event, Frame) and event.opcode is Opcode.TEXT and event.fin:
            # For invalid text the library closes the connection.
            with contextlib.suppress(UnicodeDecodeError):
                text = str(event.data, "utf-8")
        if self.hear and text is not None:
            self.hear(text)
        else:
            super().process_event(event)

    @property
    def free(self) -> bool:
        """True if the socket is open and has accepted everything sent so far."""
        transport = self.transport
        # A lost connection is closing before the library knows of it.
        is_open = self.state is State.OPEN and not transport.is_closing()
        return is_open and not transport.get_write_buffer_size()

    def send_now(self, message: bytes, text: bool) -> None:
        """Sends a message over a free socket at once, in one frame."""
        (self.protocol.send_text if text else self.protocol.send_binary)(message)
        self.send_data()
