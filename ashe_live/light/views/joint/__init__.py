"""One body with its lights, aligned in several views at once: how well they determine it, and the evidence for it."""
