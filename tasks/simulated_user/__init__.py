"""A simulated person who plays tasks by touching, and sees only what a person sees."""
