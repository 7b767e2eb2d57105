"""The layout of `--help`.

Instead of the options of a device that is not on the command line, it prints the command that shows
them.
"""

from __future__ import annotations

from collections.abc import Iterable

from cyclopts.help import HelpPanel
from cyclopts.help.formatters import DefaultFormatter
from rich.console import Console, ConsoleOptions

from sandbox.trial.trial_options import device_heading


class HelpLayout(DefaultFormatter):
    """Layout of cyclopts, without the options of devices that are not named.

    Args:
        named: Words of the command line, and default values of options. A word also names the
            device with which it begins: `leap-simulated:v1` names `leap`.
    """

    def __init__(self, named: Iterable[str]) -> None:
        super().__init__()
        words = [word.rpartition("=")[2] for word in named]
        names = [word.partition(":")[0] for word in words]
        self._named = {*words, *names, *(name.partition("-")[0] for name in names)}

    def __call__(self, console: Console, options: ConsoleOptions, panel: HelpPanel) -> None:
        """Shows the options of one heading, or the command that shows them."""
        title = str(panel.title)
        device = title.removeprefix(str(device_heading("").name))
        if device == title or device in self._named:
            super().__call__(console, options, panel)
        else:
            console.print(f"{title}: `--device {device} --help` shows its options")
