"""Singularities: their families, strokes up to them, forecasts, and rates that stay bounded."""
