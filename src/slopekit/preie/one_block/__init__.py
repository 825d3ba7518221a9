"""The limit of one block: its forces alone, with moments, on a cracked base."""
