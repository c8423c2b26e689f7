"""A robot as data: its Khalil table, solids and joint mechanics, and TOML files of it."""
