"""The smallest change of a program with which it passes: candidates, the search among them, the answer."""
