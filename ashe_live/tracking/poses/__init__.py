"""Poses from corners: solved, refined, filtered."""
