"""Edits of a program's text: rename, draw, nest, format, and others' initial values."""
