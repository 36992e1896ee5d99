"""Grading of programs: challenges, their criteria, and graded runs."""
