"""The markers there are: how each is found, read, laid out and printed."""
