"""Checks of this machine, with remedies for failed ones (`sandbox doctor`)."""
