"""The answers of `ashe-live estimate`, file by file."""
