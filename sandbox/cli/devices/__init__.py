"""`sandbox devices`."""
