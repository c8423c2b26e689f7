"""A robot in SYMORO's files: read as data, made a robot, written."""
