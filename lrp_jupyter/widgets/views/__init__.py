"""What the views of a lab show."""
