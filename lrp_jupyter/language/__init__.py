"""The language: from text to program and back, checks, differences. Pure. Paper: §3."""
