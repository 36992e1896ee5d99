"""Safety for every robot: limits, watchdogs, and the link to the process that stops it."""
