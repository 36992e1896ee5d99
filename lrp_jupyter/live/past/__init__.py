"""The past of a run: look back, repeat, fork, and what if."""
