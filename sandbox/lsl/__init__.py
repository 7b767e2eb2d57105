"""Streams of a session over Lab Streaming Layer."""
