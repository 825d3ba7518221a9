"""Interactive app: a server on this machine alone, and the page that it gives (`slopekit app`)."""
