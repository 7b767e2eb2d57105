"""Options, values and commands that were removed, and what takes their place; deleted in 1.0."""

from __future__ import annotations

from collections.abc import Sequence

from models.errors import InputError

REMOVED = {
    "subject population": "`python -m training people` in a checkout of the program makes people",
    "capture simulate --subject": "Every simulated person is of the first subject's kind",
    "train --population": "`python -m training names` and `population` train in a checkout",
    "train --builtin": "`python -m training all` makes the files that ship, in a checkout",
    "evaluate --subject": "`python -m training tables` in a checkout has the second subject",
    "evaluate --train population": "`python -m training strangers` in a checkout judges people",
    "evaluate --people": "`python -m training strangers --people` in a checkout judges people",
    "evaluate --hold-out": "`python -m training strangers --hold-out` in a checkout judges them",
    "train --encoder mean": "`sandbox evaluate --encoders mean` measures the mean pose",
    "train --encoder pca-ik-null": "`sandbox train --encoder pca-ik` is the paper's rival",
    "train --encoder map-ik": "`sandbox train --encoder pca-ik` is the paper's rival",
    "evaluate --encoders pca-ik-null": "`sandbox evaluate --encoders pca-ik` is the paper's rival",
    "evaluate --encoders map-ik": "`sandbox evaluate --encoders pca-ik` is the paper's rival",
    "study plan --from": "`--spread` takes the standard deviation over people of the difference in "
    "log time, which `sandbox study report` prints for a pilot",
    "study plan --preregistration": "The design, `sandbox study plan --power` and `sandbox study "
    "sheet` have what a preregistration needs",
}
"""Words of a command line -> what takes their place. The first words are the command's; an option
with its value, if any, may stand anywhere behind it."""


def refuse_removed(args: Sequence[str]) -> None:
    """Refuses a command line that has what was removed.

    Args:
        args: Words behind `sandbox`; `--option=value` counts as two.

    Raises:
        InputError: It has something of `REMOVED`.
    """
    words = [part for word in args for part in _parts(word)]
    for old, instead in REMOVED.items():
        command, dashes, option = old.partition(" --")
        path = command.split()
        asked, rest = words[: len(path)], words[len(path) :]
        given = f"{dashes.strip()}{option}".split()
        places = range(len(rest) - len(given) + 1)
        if asked == path and any(rest[i : i + len(given)] == given for i in places):
            raise InputError("this was removed", got=f"sandbox {old}", remedy=instead)


def _parts(word: str) -> list[str]:
    return word.split("=", 1) if word.startswith("--") else [word]
