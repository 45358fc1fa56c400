"""Four tiny instances of what the concepts must carry besides rigid bodies: solid, heat, fluid, immersed solid."""
