"""Programs with one typical mistake each, and how well the checks explain them.

``python -m tests.mistakes`` prints the figures by kind of mistake.
"""
