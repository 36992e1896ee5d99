"""Python in a text that is not Python: where it ends, how it is indented, and its parser."""
