"""Designs: what a user writes, checked and turned into numbers."""
