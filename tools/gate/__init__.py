"""The gate compares the behaviour of this checkout with `tools/gate.json`.

    python -m tools.gate            # all rows: before a merge, and in .ci/run
    python -m tools.gate --quick    # one seed a task, without study and browser: before a commit
    python -m tools.gate --update   # writes tools/gate.json; the commit message gives the reason

It plays trials of all tasks and settings, one input per device, a study that is killed and resumed,
and the page in Chromium. It prints a table, and exits with status 1 if a row differs. Two runs of
one checkout give the same rows, so a run with differences is not repeated.
"""
