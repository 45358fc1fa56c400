"""visviva: energy-momentum conserving mechanics of bodies, joints and forces as one system."""

from visviva.adaptive import Adaptive
from visviva.body.coupling import DistributedCoupling, RigidCoupling
from visviva.body.point_mass import Ground, PointMass
from visviva.body.rigid import RigidBody
from visviva.body.shape import Box, Capsule, Cone, Cylinder, Sphere, SurfaceMesh
from visviva.body.solid import Solid
from visviva.contact.contact import Contact
from visviva.contact.obstacle import Obstacle, Plane
from visviva.contact.probe import ContactArea, ContactForce
from visviva.contact.tying import Tie
from visviva.errors import InputError, RunError, VisvivaError
from visviva.formula import Formula
from visviva.joint.higher import Gear, RackAndPinion, RopeOverWinch
from visviva.joint.lower_pairs import (
    Cylindrical,
    Distance,
    Planar,
    PointOnLine,
    PointOnPlane,
    Prismatic,
    Revolute,
    Rigid,
    Screw,
    Spherical,
    Universal,
)
from visviva.joint.servo import Servo
from visviva.linear import Automatic, Direct, Iterative
from visviva.load.bushing import Bushing
from visviva.load.distributed import BodyForce
from visviva.load.drive import JointDamper, JointForce, JointSpring, Motor
from visviva.load.force import FollowerForce, Force
from visviva.load.gravity import Gravity
from visviva.load.spring import Damper, Spring
from visviva.load.support import Fixed, Prescribed, SymmetryPlane
from visviva.load.surface import ElasticFoundation, Pressure, Traction
from visviva.load.torque import FollowerTorque, Torque, TorquePair
from visviva.loading import NoEquilibrium, arc_length, quasi_static
from visviva.material.base import Material
from visviva.material.elastic import BlatzKo, LinearElastic, NeoHooke, SaintVenantKirchhoff
from visviva.material.rubber import Gent, MooneyRivlin, Ogden, Yeoh
from visviva.material.tissue import HolzapfelGasserOgden
from visviva.material.user import UserMaterial
from visviva.measure import (
    CentreOfMass,
    Direction,
    DirectorProduct,
    JointCoordinate,
    Offset,
    Position,
    Separation,
    SquaredDistance,
)
from visviva.mesh.faces import Faces
from visviva.mesh.generate import (
    BoxMesh,
    CylinderMesh,
    HollowCylinderMesh,
    HollowTorusMesh,
    QuadrilateralMesh,
    RectangleMesh,
    SphereMesh,
)
from visviva.mesh.mesh import Mesh
from visviva.mesh.read import MeshFile
from visviva.modes import Modes, modes
from visviva.probe import (
    Displacement,
    Extreme,
    FieldAt,
    SectionForce,
    SectionTorque,
    SupportForce,
    SupportTorque,
    Velocity,
)
from visviva.reaction import ReactionForce, ReactionTorque, ServoInputs, reaction
from visviva.result import Result
from visviva.scheme import (
    ArcLength,
    BackwardEuler,
    EnergyMomentum,
    GeneralizedAlpha,
    Midpoint,
    Scheme,
    Static,
    VariationalMidpoint,
)
from visviva.solve import march, simulate
from visviva.statics import equilibrium
from visviva.study import Study
from visviva.system import Newton, StepFailure, System
from visviva.term import Term
from visviva.timefunction import TimeFunction
from visviva.user import Constraint, GeneralizedForce, Potential, UserTerm

__all__ = [
    "Adaptive",
    "ArcLength",
    "Automatic",
    "BackwardEuler",
    "BlatzKo",
    "BodyForce",
    "Box",
    "BoxMesh",
    "Bushing",
    "Capsule",
    "CentreOfMass",
    "Cone",
    "Constraint",
    "Contact",
    "ContactArea",
    "ContactForce",
    "Cylinder",
    "CylinderMesh",
    "Cylindrical",
    "Damper",
    "Direct",
    "Direction",
    "DirectorProduct",
    "Displacement",
    "Distance",
    "DistributedCoupling",
    "ElasticFoundation",
    "EnergyMomentum",
    "Extreme",
    "Faces",
    "FieldAt",
    "Fixed",
    "FollowerForce",
    "FollowerTorque",
    "Force",
    "Formula",
    "Gear",
    "GeneralizedAlpha",
    "GeneralizedForce",
    "Gent",
    "Gravity",
    "Ground",
    "HollowCylinderMesh",
    "HollowTorusMesh",
    "HolzapfelGasserOgden",
    "InputError",
    "Iterative",
    "JointCoordinate",
    "JointDamper",
    "JointForce",
    "JointSpring",
    "LinearElastic",
    "Material",
    "Mesh",
    "MeshFile",
    "Midpoint",
    "Modes",
    "MooneyRivlin",
    "Motor",
    "NeoHooke",
    "Newton",
    "NoEquilibrium",
    "Obstacle",
    "Offset",
    "Ogden",
    "Planar",
    "Plane",
    "PointMass",
    "PointOnLine",
    "PointOnPlane",
    "Position",
    "Potential",
    "Prescribed",
    "Pressure",
    "Prismatic",
    "QuadrilateralMesh",
    "RackAndPinion",
    "ReactionForce",
    "ReactionTorque",
    "RectangleMesh",
    "Result",
    "Revolute",
    "Rigid",
    "RigidBody",
    "RigidCoupling",
    "RopeOverWinch",
    "RunError",
    "SaintVenantKirchhoff",
    "Scheme",
    "Screw",
    "SectionForce",
    "SectionTorque",
    "Separation",
    "Servo",
    "ServoInputs",
    "Solid",
    "Sphere",
    "SphereMesh",
    "Spherical",
    "Spring",
    "SquaredDistance",
    "Static",
    "StepFailure",
    "Study",
    "SupportForce",
    "SupportTorque",
    "SurfaceMesh",
    "SymmetryPlane",
    "System",
    "Term",
    "Tie",
    "TimeFunction",
    "Torque",
    "TorquePair",
    "Traction",
    "Universal",
    "UserMaterial",
    "UserTerm",
    "VariationalMidpoint",
    "Velocity",
    "VisvivaError",
    "Yeoh",
    "arc_length",
    "equilibrium",
    "march",
    "modes",
    "quasi_static",
    "reaction",
    "simulate",
]

__version__ = "0.1.0"
