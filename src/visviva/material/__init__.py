"""Materials: an energy each, nothing else."""
