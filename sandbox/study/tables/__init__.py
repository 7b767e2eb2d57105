"""Tables derived from a study's journals and recordings."""
