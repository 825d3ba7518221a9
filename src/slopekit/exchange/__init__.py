"""Blocks, interfaces and node pairs of a result as files of other programs, and closed meshes read back."""
