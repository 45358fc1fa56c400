"""Contact between surfaces of solids and rigid bodies."""
