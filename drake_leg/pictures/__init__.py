"""Pictures of recordings, robots and diagrams."""
