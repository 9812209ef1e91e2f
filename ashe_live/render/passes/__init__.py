"""The passes in which a picture is drawn, each a module."""
