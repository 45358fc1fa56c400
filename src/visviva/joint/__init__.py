"""Joints: constraints between points and frames of any component."""
