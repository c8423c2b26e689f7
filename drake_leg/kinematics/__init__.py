"""Closed forms and chains on NumPy; imports no Drake."""
