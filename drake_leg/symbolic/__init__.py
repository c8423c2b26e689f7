"""Derives the reports' matrices and equations again from the Khalil rows, with SymPy."""
