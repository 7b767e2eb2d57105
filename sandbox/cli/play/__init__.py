"""`sandbox play`."""
