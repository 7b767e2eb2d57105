"""What exists in the world, and the types that cross from room to room."""
