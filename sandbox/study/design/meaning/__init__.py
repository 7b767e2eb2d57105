"""What a design that is right in form may get wrong."""
