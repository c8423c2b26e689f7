"""Many runs: sweeps over whatever a run takes, and answers for thousands of legs at once."""
