"""Editors beyond the lab: a language server, what a running program tells it, and settings of editors."""
