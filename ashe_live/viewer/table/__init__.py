"""The models on the table: which there are, where they stand, and how keys and mouse change them."""
