"""What `ashe-live estimate` says of each file."""
