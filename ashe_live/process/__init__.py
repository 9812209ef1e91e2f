"""This process and those that it starts: signals, standard streams, messages to a person, children and pipes to them.

Imports errors only; every other room may import it.
"""
