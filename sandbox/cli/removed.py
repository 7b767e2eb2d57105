"""Options, values and commands that were removed, and what takes their place; deleted in 1.0."""

from __future__ import annotations

from collections.abc import Sequence

from models.errors import InputError

REMOVED = {
    "calibrate": "`sandbox hand measure` measures a hand",
    "rest": "`sandbox hand rest` sees a hand at rest",
    "profile --forget": "`sandbox hand forget` forgets layouts",
    "profile": "`sandbox hand show` shows a profile",
    "leap": "`sandbox devices leap` has its commands",
    "webcam": "`sandbox devices webcam` has its commands",
    "robot": "`sandbox devices robot` has its commands",
    "subject population": "`python -m training people` in a checkout of the program makes people",
    "capture simulate --subject": "Every simulated person is of the first subject's kind",
    "train --population": "`python -m training names` and `population` train in a checkout",
    "train --builtin": "`python -m training all` makes the files that ship, in a checkout",
    "evaluate --subject": "`python -m training tables` in a checkout has the second subject",
    "evaluate --train population": "`python -m training strangers` in a checkout judges people",
    "evaluate --people": "`python -m training strangers --people` in a checkout judges people",
    "evaluate --hold-out": "`python -m training strangers --hold-out` in a checkout judges them",
    "evaluate --readings": "docs/paalm.md has the table of readings of the paper",
    "train --encoder mean": "`sandbox evaluate --encoders mean` measures the mean pose",
    "train --encoder pca-ik-null": "`sandbox train --encoder pca-ik` is the paper's rival",
    "train --encoder map-ik": "`sandbox train --encoder pca-ik` is the paper's rival",
    "evaluate --encoders pca-ik-null": "`sandbox evaluate --encoders pca-ik` is the paper's rival",
    "evaluate --encoders map-ik": "`sandbox evaluate --encoders pca-ik` is the paper's rival",
    "--encoder best": "`--encoder population` is the default; `sandbox train` makes one's own",
    "evaluate --encoders best": "`--encoders trained` is trained on the person's day 0",
    "--labels history": "`--labels population` is the default",
    "--without history": "`--labels paper` labels by the paper's rule",
    "--without ghost": "`--no-ghost-until-clear` takes its place",
    "--without distal": "`--no-distal-only` takes its place",
    "--without encoder": "`--no-encode` takes its place",
    "--without": "`--no-correction`, `--no-smoothing` and others take its place",
    "--tell-labels": "`--labels device` uses the labels of the simulated user",
    "hand rest --looks": "`--samples` takes its place",
    "study backup": "`tar -czf FILE STUDY` makes an archive, between two sessions; `sandbox replay "
    "STUDY --verify` verifies what was unpacked",
    "study export --bids": "`sandbox study share` makes a folder of CSV tables with a codebook",
    "study export": "`sandbox study share STUDY --out FOLDER` makes the folder for others; `tar "
    "-czf FILE STUDY` copies everything as it is",
    "study run --witness": "The session prints its last digest; write it down, or keep a copy of "
    "notes/A.jsonl",
    "study simulate --witness": "Each session prints its last digest",
    "replay --witness": "`tail -n 1 session.jsonl` of a session has the digest that it printed",
    "study plan --from": "`study plan --power --detect SD` takes standard deviations over people",
    "study plan --spread": "`study plan --power` counts in standard deviations over people",
    "study plan --preregistration": "`sandbox study plan --markdown` prints it",
    "study merge": "Folders are merged by copying: `cp -r siteB/NAME/* siteA/NAME/`, where each "
    "site has run with a letter of its own (`sandbox study run --site B`)",
    "study withdraw": "`sandbox study note STUDY --participant ID --withdraw` deletes their data",
    "study recover": "`sandbox study note STUDY --participant ID --accept-loss REASON` accepts "
    "what is there",
}
"""Words of a command line -> what takes their place. The first words are the command's, if it is
about one command; an option with one of its values, if any, may stand anywhere behind it."""


def refuse_removed(args: Sequence[str]) -> None:
    """Refuses a command line that has what was removed.

    Args:
        args: Words behind `sandbox`; `--option=value` counts as two.

    Raises:
        InputError: It has something of `REMOVED`.
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
    """True if an option is among words, with this value among its values unless it is empty."""
    given = ""
    for word in words:
        given = word if word.startswith("--") else given
        if given == option and value in ("", word):
            return True
    return False


def _parts(word: str) -> list[str]:
    return word.split("=", 1) if word.startswith("--") else [word]
