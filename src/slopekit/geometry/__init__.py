"""Bodies to cut, the cutting, and the node pairs on the interfaces: arrays in, arrays out."""
