"""Checks of this machine, with remedies for failed checks (`sandbox doctor`)."""
