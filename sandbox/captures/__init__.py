"""Captures of one's own hand: touches, and what sees the hand, recorded and read together."""
