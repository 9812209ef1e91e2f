"""What keys and mouse ask for, and what they do to light and model."""
