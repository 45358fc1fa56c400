"""Mechanisms against independent references: convergence orders, conserved quantities, reactions."""
