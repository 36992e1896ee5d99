"""The text of a lab: shared by its views, and kept in files."""
