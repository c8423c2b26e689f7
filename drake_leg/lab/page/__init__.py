"""Every figure and table of both reports on one page."""
