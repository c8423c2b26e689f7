"""A robot as data: Khalil table, solids and joint mechanics, read from and written to TOML."""
