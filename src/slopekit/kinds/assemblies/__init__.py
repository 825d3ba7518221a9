"""Scene, limit, states and notices of assemblies of many blocks, shared by their kinds."""
