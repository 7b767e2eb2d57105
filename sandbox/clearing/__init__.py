"""Hands that are solid all over: how far their parts are from things, and how they keep clear."""
