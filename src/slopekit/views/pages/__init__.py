"""Pages of results: one document or several, in HTML."""
