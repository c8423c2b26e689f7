"""What the notebooks need besides the package: answers that are checked, and things to show."""
