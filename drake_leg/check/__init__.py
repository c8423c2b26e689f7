"""Proving a robot: its table read for slips, its chain against SymPy and Drake, a print graded."""
