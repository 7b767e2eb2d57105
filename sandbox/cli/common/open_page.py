"""The server of the browser page, by its options."""

from __future__ import annotations

from models.errors import InputError
from sandbox.options.page_options import PageOptions
from sandbox.options.profiles import default_path
from sandbox.recording.versions import versions
from sandbox.server.connections.kept_token import kept_token
from sandbox.server.page_server import PageServer, tls_context
from sandbox.server.protocol.describe import summary
from sandbox.server.protocol.protocol import StudyView, TaskName
from sandbox.server.static import HEADSET, StaticFiles
from tasks.registry import TASKS, hands_of


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
