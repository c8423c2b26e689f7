"""The Simulink diagrams of the reports, one a file."""
