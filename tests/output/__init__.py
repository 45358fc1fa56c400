"""The output layer: files that survive kills and full disks, plots, pictures, movies."""
