"""The mechanism of a Simulink model in motion: its plant, what acts on it, what senses it."""
