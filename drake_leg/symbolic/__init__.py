"""The reports' matrices and equations derived again from the Khalil rows, with SymPy.

SymPy is an extra: ask ``optional.require_sympy`` before importing another module of this room.
"""
