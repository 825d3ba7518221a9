"""What a user writes, checked and turned into numbers."""
