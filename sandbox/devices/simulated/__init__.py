"""Simulated users as devices."""
