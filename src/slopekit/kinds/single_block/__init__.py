"""Parts that the kinds of one block share: from the loaded block to limit, checks and result."""
