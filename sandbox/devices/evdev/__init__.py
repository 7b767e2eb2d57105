"""Touch screens and trackpads of a Linux machine."""
