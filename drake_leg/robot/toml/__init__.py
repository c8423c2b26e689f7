"""A robot in TOML: read and written."""
