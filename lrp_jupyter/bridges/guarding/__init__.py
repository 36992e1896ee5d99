"""Safety for every robot: limits, watchdogs, and the process that stops it."""
