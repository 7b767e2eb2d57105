"""Runs a session of a study: trials, forms and the participant's page."""
