"""Judging a program: challenges, what they ask for, and graded runs of them."""
