"""The commands with their options and help texts, a file for each subject; other modules implement them."""
