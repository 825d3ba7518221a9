"""Blocks at one factor and in motion: equilibrium, displacements, the paper's criterion, shaking."""
