"""What stands on the table: which models there are, where, and what hand and keys do to them."""
