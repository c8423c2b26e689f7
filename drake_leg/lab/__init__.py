"""The two reports: their page, their errata, the grader of printed formulas, the exercises."""
