"""The gate compares the behaviour of this checkout with `tools/gate.json`.

    python -m tools.gate            # whole: before a landing, and in .ci/run
    python -m tools.gate --quick    # one seed a task, without study and browser: before a commit
    python -m tools.gate --update   # writes tools/gate.json; the commit says why

It prints one table, and exits with 1 where anything differs. It plays trials of all tasks and
settings, one input per device, a study that is killed and resumed, and the page in Chromium. Two
runs of one checkout give the same rows; a run that differs is never repeated in the hope of
another result.
"""
