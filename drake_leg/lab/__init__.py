"""The reports: their page, their errata, the grader of prints, and the lessons."""
