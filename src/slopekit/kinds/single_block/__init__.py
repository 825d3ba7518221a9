"""What the kinds of one block share: from what is cut and loaded to the limit, its checks and its result."""
