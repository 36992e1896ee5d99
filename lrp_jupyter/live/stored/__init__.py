"""What recordings are made of: lines of JSON."""
