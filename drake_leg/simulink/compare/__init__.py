"""A Simulink model beside the live diagram: which block is which, and what differs."""
