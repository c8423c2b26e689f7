"""The blocks that Drake lacks, one a file."""
