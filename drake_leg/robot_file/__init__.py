"""A robot as a TOML file: read and written."""
