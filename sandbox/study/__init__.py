"""User studies: plans of sessions, running them, journals that survive kills, and reports."""
