"""The pictures of PAALM."""
