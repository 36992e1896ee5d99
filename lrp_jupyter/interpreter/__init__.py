"""Running a program: ticks, faults, live changes. No clock, no thread, no input or output."""
