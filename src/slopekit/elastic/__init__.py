"""Elastic blocks: what the deformation of the rock does to the rigid answer (extra: elastic, scikit-fem).

Arrays in, arrays out; nothing of it loads unless a design is asked for with `--elastic`.
"""
