"""Runs a command once, and prints which files of this project took part.

    python -m tools.trace touch             # from a touch on the page to the servos and back
    python -m tools.trace regress           # one trial of `sandbox regress`
    python -m tools.trace study             # two trials of a study, by a simulated participant
    python -m tools.trace touch --list      # each file with its functions, in order
    python -m tools.trace study --json OUT  # numbers and names, for programs

The real command runs in this process. Functions of all threads are counted.

    files imported         files of the four packages that were imported, from the beginning on
    files that took part   files of which at least one function ran
    functions              functions and lambdas that ran; a comprehension is part of its function
    classes                classes of which a method ran
    calls of Python code   calls in all files, also in libraries and imports; with the share of `re`

A function that runs only while a module is being imported does not count. In `touch`, five fingers
of a client come down on `sandbox play --view web` and move for a second. Only these steps are
counted, and not the building of the session; its imports are counted. The --list of `touch` begins
where the message arrives. Each file is listed when it first takes part.
"""
