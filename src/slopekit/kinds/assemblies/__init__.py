"""What the kinds of many blocks share: scene, limit, states, notices."""
