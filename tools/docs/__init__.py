"""Makes pictures and pages of the documentation."""
