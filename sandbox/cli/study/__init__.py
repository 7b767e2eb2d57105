"""`sandbox study`."""
