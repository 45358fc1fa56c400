"""The script of the README: an arm on a hinge, a ball on a spring at its end."""

import visviva as vv

ground = vv.Ground()
arm = vv.RigidBody(shape=vv.Box(size=(1.0, 0.1, 0.1)), density=500.0, position=(0.5, 0, 0), name="arm")
ball = vv.PointMass(mass=2.0, position=(1.5, 0, 0), name="ball")
hinge = vv.Revolute(a=ground, b=arm, at=(0, 0, 0), axis=(0, 1, 0), angle=True, name="hinge")
spring = vv.Spring(a=arm.point((0.5, 0, 0)), b=ball, stiffness=400.0, free_length=0.4, name="spring")
system = vv.System([ground, arm, ball, hinge, spring, vv.Gravity()])

print(system.check())  # freedoms, redundant constraints by name, tangents
result = vv.simulate(system, until=10.0, step=0.01)
result.audit()  # what was conserved, and how well
print("angle [rad]", result.history(hinge.coordinate())[-1], "reaction [N]", vv.reaction(system, hinge)[0])
result.assert_conserved("energy", "constraints", tolerance=1e-9)
