"""From a pilot to a plan: spread, power and numbers of people; the text of a preregistration."""
