"""The protocol between server and page."""
