"""The errors in the two reports: what is printed, what is right, and the error's effect."""
