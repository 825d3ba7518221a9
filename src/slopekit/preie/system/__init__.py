"""The models that the solvers take, as arrays: blocks, node pairs, loads, bolts, strengths."""
