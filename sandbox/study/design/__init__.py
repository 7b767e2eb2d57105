"""The design of a study, its orders of levels, and the plans of sessions."""
