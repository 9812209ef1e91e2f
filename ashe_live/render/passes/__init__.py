"""What one picture is drawn in: each pass a module."""
