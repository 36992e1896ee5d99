"""The smallest change that makes a program pass: candidates, the search among them, the answer."""
