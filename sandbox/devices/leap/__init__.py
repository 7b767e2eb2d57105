"""The Leap Motion controller: live, from files, and written."""
