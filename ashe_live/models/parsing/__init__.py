"""What all readers of model files need: limits, folders, pictures, and words for what is wrong."""
