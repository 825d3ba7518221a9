"""What is solved, as arrays: one block or many, their node pairs, loads, bolts and strengths."""
