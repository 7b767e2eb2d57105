"""`sandbox touches`."""
