"""Which finger each contact is."""
