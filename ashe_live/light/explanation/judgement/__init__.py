"""How likely an explanation is: its features, the probability that it is right, and its uncertainty."""
