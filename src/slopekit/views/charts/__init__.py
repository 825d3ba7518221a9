"""Charts (matplotlib), each from the JSON of its document. Need the extra `plot`."""
