"""The Leap Motion controller: live, from files, and a writer of its files."""
