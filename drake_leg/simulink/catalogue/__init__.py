"""What is known of Simulink's and Simscape's blocks: their parameters, defaults and units."""
