"""Incompressible flow: fluids, what happens at their boundary, what is measured of them."""
