"""The real object's shadows as a picture shows them: where they end, and the lit ground at their border."""
