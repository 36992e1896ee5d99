"""What goes between a page and the kernel: messages, their types, and how they are written."""
