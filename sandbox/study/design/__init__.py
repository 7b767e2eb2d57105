"""The design of a study, and what follows from it: orders and plans."""
