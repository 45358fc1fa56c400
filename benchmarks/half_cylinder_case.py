"""The half cylinder of Liu et al. (2014) on the floor of a channel: places and elasticity, for every code alike."""

RADIUS, CENTRE, LENGTH, FLOOR, HEIGHT = 0.5, (1.5, -0.5), 6.5, -0.5, 1.5
LAME, SHEAR = 500.0, 50.0
