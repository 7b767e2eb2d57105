"""Removed options, values and commands, each with its replacement; deleted in version 1.0."""

from __future__ import annotations

from collections.abc import Sequence

from models.errors import InputError

REMOVED = {
    "calibrate": "`sandbox hand measure` measures a hand",
    "rest": "`sandbox hand rest` measures the rest posture of a hand",
    "profile --forget": "`sandbox hand forget` deletes layouts",
    "profile": "`sandbox hand show` shows a profile",
    "leap": "Its commands are now commands of `sandbox devices leap`",
    "webcam": "Its commands are now commands of `sandbox devices webcam`",
    "robot": "Its commands are now commands of `sandbox devices robot`",
    "subject population": "`python -m training people` makes simulated people, in a checkout",
    "capture simulate --subject": "Leave it out: there is only one kind of simulated subject",
    "train --population": "`python -m training names` and `python -m training population` train "
    "the models that ship, in a checkout",
    "train --builtin": "`python -m training all` makes the files that ship, in a checkout",
    "evaluate --subject": "`python -m training tables` has the second subject, in a checkout",
    "evaluate --train population": "`python -m training strangers` in a checkout judges people",
    "evaluate --people": "`python -m training strangers --people` in a checkout judges people",
    "evaluate --hold-out": "`python -m training strangers --hold-out` in a checkout judges them",
    "evaluate --readings": "docs/paalm.md has the table of readings of the paper",
    "train --encoder mean": "`sandbox evaluate --encoders mean` measures the mean pose",
    "train --encoder pca-ik-null": "Use `sandbox train --encoder pca-ik`",
    "train --encoder map-ik": "Use `sandbox train --encoder pca-ik`",
    "evaluate --encoders pca-ik-null": "Use `sandbox evaluate --encoders pca-ik`",
    "evaluate --encoders map-ik": "Use `sandbox evaluate --encoders pca-ik`",
    "--encoder best": "Use `--encoder population`, the default, or train your own encoder with "
    "`sandbox train`",
    "evaluate --encoders best": "Use `--encoders trained`, which is trained on the person's day 0",
    "--labels history": "Use `--labels population`, the default",
    "--without history": "Use `--labels paper`, the labels by the paper's rule",
    "--without ghost": "Use `--no-ghost-until-clear`",
    "--without distal": "Use `--no-distal-only`",
    "--without encoder": "Use `--no-encode`",
    "--without": "Use `--no-correction`, `--no-smoothing` or another `--no-...` option",
    "--tell-labels": "`--labels device` uses the labels of the simulated user",
    "hand rest --looks": "Use `--samples`",
    "study backup": "`tar -czf FILE STUDY` makes an archive; run it between two sessions. `sandbox "
    "replay STUDY --verify` verifies an unpacked archive",
    "study export --bids": "`sandbox study share` makes a folder of CSV tables with a codebook",
    "study export": "`sandbox study share STUDY --out FOLDER` makes the folder for others; `tar "
    "-czf FILE STUDY` copies the whole study",
    "study run --witness": "The session prints its last hash; write it down, or store a copy of "
    "notes/A.jsonl elsewhere",
    "study simulate --witness": "Each session prints its last hash",
    "replay --witness": "`tail -n 1 session.jsonl` of a session shows the hash that it printed",
    "study plan --from": "`study plan --power --detect SD` takes standard deviations over people",
    "study plan --spread": "`study plan --power` counts in standard deviations over people",
    "study plan --preregistration": "`sandbox study plan --markdown` prints it",
    "study merge": "Merge folders by copying: `cp -r siteB/NAME/* siteA/NAME/`. Each site must "
    "have run with its own letter (`sandbox study run --site B`)",
    "study withdraw": "`sandbox study note STUDY --participant ID --withdraw` deletes their data",
    "study recover": "`sandbox study note STUDY --participant ID --accept-loss REASON` accepts "
    "the remaining data",
}
"""Removed words of a command line -> replacement.

The words are a command, an option, or both, and may end with a value of the option. The words of a
command must be the first of the command line; option and value may be anywhere after them.
"""


def refuse_removed(args: Sequence[str]) -> None:
    """Refuses a command line with a removed command, option or value.

    Args:
        args: Words after `sandbox`; `--option=value` counts as two words.

    Raises:
        InputError: The words contain an entry of `REMOVED`.
    """
    words = [part for word in args for part in _parts(word)]
    for old, instead in REMOVED.items():
        command, _, rest = f" {old}".partition(" --")
        path = command.split()
        option, _, value = rest.partition(" ")
        if words[: len(path)] == path and (not option or _has(words, f"--{option}", value)):
            got = f"sandbox {old}" if path else old
            raise InputError("this was removed", got=got, remedy=instead)


def _has(words: Sequence[str], option: str, value: str) -> bool:
    """True if an option is among words. A value that is not empty must be among the option's
    values."""
    given = ""
    for word in words:
        given = word if word.startswith("--") else given
        if given == option and value in ("", word):
            return True
    return False


def _parts(word: str) -> list[str]:
    return word.split("=", 1) if word.startswith("--") else [word]
