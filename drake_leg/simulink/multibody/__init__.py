"""The bodies of a Simscape Multibody model."""
