"""Runs kept beside a program: examples that are run again, and judged, with every new text of the program."""
