"""User studies: plans of sessions, their runs, journals that survive a crash, and reports."""
