"""Meshes: nodes, cells by type and named sets; made by counts or read from files. They know no physics."""
