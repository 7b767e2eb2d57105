"""Play: one trial after another, in a window and on pages, as the player requests."""
