"""What is to be done, and whether it was done."""
