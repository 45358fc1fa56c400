"""Tiny instances of what the concepts carry besides rigid bodies: solid, heat, fluid, immersed solid."""
