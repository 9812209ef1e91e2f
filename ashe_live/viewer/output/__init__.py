"""What leaves the viewer: snapshots, recordings, reports."""
