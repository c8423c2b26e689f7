"""From recordings to pictures; imports no Drake."""
