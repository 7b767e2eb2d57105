"""How a study treats those who take part: whom it chooses, what it has them do, and owes them."""
