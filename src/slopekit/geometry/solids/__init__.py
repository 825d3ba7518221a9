"""The user's closed meshes and curved slip surfaces: read, checked, where they touch."""
