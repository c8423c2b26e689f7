"""Six legs that walk: gaits, legs, loads and margins as functions of time, without Drake."""
