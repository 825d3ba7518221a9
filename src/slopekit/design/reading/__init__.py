"""From a file or a mapping to located values, every fault at once."""
