"""A session of a study while it runs: trials, forms and the participant's page."""
