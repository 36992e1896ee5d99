"""Views of a program that need no browser: its state graph, layouts and still pictures."""
