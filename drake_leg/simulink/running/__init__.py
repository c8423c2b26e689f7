"""A Simulink model runs: its signals as code of our own making, its mechanism as Drake's plant."""
