"""The viewer's output: snapshots, recordings, reports."""
