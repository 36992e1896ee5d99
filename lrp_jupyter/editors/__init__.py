"""What other editors and tools need for programs: their colours, and how they are set up."""
