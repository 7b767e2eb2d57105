"""Runs a path through the program once, and prints which of its own files took part.

    python -m tools.trace touch             # a touch on the page, to the servos and back in a frame
    python -m tools.trace regress           # one trial of `sandbox regress`
    python -m tools.trace study             # two trials of a study, by a simulated participant
    python -m tools.trace touch --list      # each file with its functions, in order
    python -m tools.trace study --json OUT  # numbers and names, for programs

The path is the real command, in this process. All threads are counted.

    files imported         files of the four packages that were imported from the beginning on
    files that took part   files of which at least one function ran
    functions              functions and lambdas that ran; a comprehension is part of its function
    classes                classes of which a method ran
    calls of Python code   in any file, also of libraries, and in imports; with the share of `re`

A function that runs only while a module is being imported takes no part. Of `touch` only the steps
are counted: five fingers of a client come down on `sandbox play --view web` and move for a second.
Building the session is not counted; its imports are. Its --list
begins where the message arrives, and names each file with its functions when it first takes part.
"""
