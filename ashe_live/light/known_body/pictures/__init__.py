"""The pictures of a known body, and what several of them say together."""
