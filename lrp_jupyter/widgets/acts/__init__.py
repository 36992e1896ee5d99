"""What a page can do and ask, one function each."""
