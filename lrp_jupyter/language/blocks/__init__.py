"""Blocks: Python between square brackets, bound to the variables of a program."""
