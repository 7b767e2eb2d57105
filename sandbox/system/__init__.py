"""What operating systems do in different ways."""
