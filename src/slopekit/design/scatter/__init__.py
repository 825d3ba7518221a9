"""Values that scatter: their distributions, and how they go together."""
