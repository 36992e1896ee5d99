"""A program that runs: its loop, thread and time, its commands, and the record that is kept of it."""
