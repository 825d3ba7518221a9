"""Closed forms from the literature. They judge the numerical side and share nothing with it but orientations."""
