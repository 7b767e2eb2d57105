"""What makes shipped files and what measures this repository; nothing here is in the wheel."""
