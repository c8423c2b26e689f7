"""The page with every figure, table and equation of both reports."""
