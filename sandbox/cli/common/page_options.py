"""Options of commands that serve the browser page, and its server."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter

from models.errors import InputError
from sandbox.options.headings import COMMON, PAGE
from sandbox.options.profiles import default_path
from sandbox.recording.versions import versions
from sandbox.server.connections.address import LOOPBACK, checked_address, local_network_address
from sandbox.server.connections.kept_token import kept_token
from sandbox.server.page_server import PageServer, tls_context
from sandbox.server.protocol.describe import summary
from sandbox.server.protocol.protocol import StudyView, TaskName
from sandbox.server.static import HEADSET, StaticFiles
from tasks.registry import TASKS, hands_of


@dataclass(frozen=True, kw_only=True)
class PageOptions:
    """Options of the page's server."""

    tablet: Annotated[bool, Parameter(group=COMMON)] = False
    """Play on a tablet in the same network: prints a QR code to scan. Same as --device web, on this
    machine's network address."""

    lan: Annotated[str | None, Parameter(group=PAGE, metavar="ADDRESS")] = None
    """Address on which the page is served, in place of the one that --tablet finds."""

    page_port: Annotated[int, Parameter(group=PAGE)] = 0
    """TCP port of the page; 0 takes a free one. With a fixed port the link stays the same, and an
    open page reconnects when the program is restarted."""

    tls_cert: Annotated[str | None, Parameter(group=PAGE, metavar="FILE")] = None
    """Certificate for https, with --tls-key. Tablets refuse self-signed certificates."""

    tls_key: Annotated[str | None, Parameter(group=PAGE, metavar="FILE")] = None
    """Key of the certificate."""

    @property
    def page_host(self) -> str:
        """Address on which the page is served."""
        if self.lan:
            return checked_address(self.lan)
        return local_network_address() if self.tablet else LOOPBACK


def open_page(
    options: PageOptions,
    study: StudyView | None = None,
    touch: bool = True,
    headset: bool = False,
) -> PageServer:
    """Starts the server of the page.

    Args:
        options: Address, port and certificate.
        study: View of a study, which has no menus; None for play.
        touch: True if the player's page moves the hand.
        headset: True for the page of a headset, False for that of fingers on a screen.

    Raises:
        DeviceError: The address or port is not available.
        InputError: The certificate or its key is missing or wrong.
    """
    if not 0 <= options.page_port <= 65535:
        raise InputError(
            "no such port",
            where="--page-port",
            got=options.page_port,
            expected="0 to 65535; 0 takes a free one",
        )
    if (options.tls_cert is None) != (options.tls_key is None):
        raise InputError(
            "a certificate needs its key, and a key its certificate",
            where="--tls-cert, --tls-key",
        )
    tls = None
    if options.tls_cert and options.tls_key:
        tls = tls_context(options.tls_cert, options.tls_key)
    tasks = [
        TaskName(name, summary(task), task.lift_range > 0)
        for name, task in TASKS.items()
        if hands_of(task) == 1
    ]
    program = str(versions()["hand-sandbox"])
    token = kept_token(default_path().with_name("page-token")) if options.page_port else ""
    return PageServer(
        options.page_host,
        options.page_port,
        tasks,
        program,
        tls,
        files=StaticFiles(index=HEADSET) if headset else None,
        token=token,
        study=study,
        touch=touch,
    )
