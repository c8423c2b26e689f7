"""Networks of one dimension, mechanical and electrical: their blocks, equations and states."""
