"""A network between a browser and a server that can go away and come back."""

from __future__ import annotations

import contextlib
import socket
import threading

ADDRESS = "127.0.0.2"
"""Address at which the server is reached through the network."""
_PIECE = 65536


class Network:
    """Passes connections to a server on 127.0.0.1, at the same port of another address.

    While it is away, bytes wait, and connections are made that nobody answers, as in a Wi-Fi that
    lost its link.

    Args:
        port: Port of the server.
    """

    def __init__(self, port: int) -> None:
        self._port = port
        self._there = threading.Event()
        self._there.set()
        self._open: list[socket.socket] = []
        self._listening = socket.create_server((ADDRESS, port))
        threading.Thread(target=self._accept, daemon=True).start()

    def leave(self) -> None:
        """The network goes away."""
        self._there.clear()

    def come_back(self) -> None:
        """The network is back, with all that waited."""
        self._there.set()

    def close(self) -> None:
        """Ends all connections."""
        self._there.set()
        with contextlib.suppress(OSError):
            # Closing alone would not wake the thread that accepts.
            self._listening.shutdown(socket.SHUT_RDWR)
        self._listening.close()
        for end in self._open:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._listening.accept()
                threading.Thread(target=self._join, args=(near,), daemon=True).start()

    def _join(self, near: socket.socket) -> None:
        self._there.wait()
        try:
            far = socket.create_connection(("127.0.0.1", self._port))
        except OSError:
            near.close()
            return
        for end in (near, far):
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._open.append(end)
        for pair in ((near, far), (far, near)):
            threading.Thread(target=self._pass_on, args=pair, daemon=True).start()

    def _pass_on(self, source: socket.socket, sink: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while piece := source.recv(_PIECE):
                self._there.wait()
                sink.sendall(piece)
        with contextlib.suppress(OSError):
            sink.shutdown(socket.SHUT_WR)
