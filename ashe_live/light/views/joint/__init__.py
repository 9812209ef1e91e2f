"""One body with its lights, aligned in several views at once: how far they tell it, and what they say for it."""
