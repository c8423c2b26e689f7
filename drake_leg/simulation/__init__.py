"""From a diagram to what its scopes recorded: integrator, guard, recording."""
