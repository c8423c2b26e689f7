"""What the command line carries out: options, a run, its files."""
