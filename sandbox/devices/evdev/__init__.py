"""Linux touch screens and trackpads."""
