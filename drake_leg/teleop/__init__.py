"""A leg driven by hand: the foot's velocity in real time, guarded against singularities."""
