"""Elastic joints without tension: rest, flow, and the path on which strength or load change."""
