"""Programs that make files of this repository or measure it. They are not in the wheel."""
