"""Attacks on the tracker: pictures in which it must not be sure of what is not so."""
