"""Views: pages, charts, scenes and texts for people."""
