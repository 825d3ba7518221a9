"""Blocks of a vertical section: polygons, columns, where they touch."""
