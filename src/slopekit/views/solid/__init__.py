"""Scenes of blocks in space: what is drawn, from where, and by what."""
