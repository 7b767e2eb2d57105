"""User studies: who does what in which order, and a record of it that nothing can lose."""
