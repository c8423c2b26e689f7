"""A Simulink model compared with a live diagram: which block is which, and what differs."""
