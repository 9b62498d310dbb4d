"""Time and memory of the program beside those of its peers."""
