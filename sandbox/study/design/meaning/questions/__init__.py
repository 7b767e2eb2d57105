"""What the questions of a design may get wrong."""
