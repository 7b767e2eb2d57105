"""`sandbox evaluate`."""
