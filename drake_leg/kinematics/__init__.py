"""Forward and inverse kinematics on NumPy, in closed form and of any chain, without Drake."""
