"""Makes the skin that ships; needs the extra `skin`."""
