# Public names, and where they are: each module is loaded when one of its names is first used.
from .analysis.adaptive import Adaptive
from .analysis.arc_length import ArcLength, arc_length
from .analysis.eigenmodes import Modes, modes
from .analysis.load_steps import NoEquilibrium, Static, quasi_static
from .analysis.march import march, simulate
from .analysis.relaxation import equilibrium
from .base.errors import InputError, RunError, VisvivaError
from .base.timefunction import TimeFunction
from .body.coupling import DistributedCoupling, RigidCoupling
from .body.point_mass import Ground, PointMass
from .body.rigid import RigidBody
from .body.shape import Box, Capsule, Cone, Cylinder, Sphere, SurfaceMesh
from .body.solid import Solid
from .contact.contact import Contact
from .contact.obstacle import Obstacle, Plane
from .contact.tying import Tie
from .flow.boundary import FreeSlip, NoSlip, VelocityBoundary
from .flow.fluid import Fluid
from .flow.immersed import Immersed
from .flow.immersed_body import ImmersedBody
from .flow.opening import FluidTraction, Outlet
from .joint.higher import Gear, RackAndPinion, RopeOverWinch
from .joint.lower_pairs import (
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
from .linear.choice import Automatic, Direct, Iterative
from .load.bushing import Bushing
from .load.distributed import BodyForce
from .load.drive import JointDamper, JointForce, JointSpring, Motor
from .load.force import FollowerForce, Force
from .load.gravity import Gravity
from .load.spring import Damper, Spring
from .load.support import Fixed, Prescribed, SymmetryPlane
from .load.surface_loads import ElasticFoundation, Pressure, Traction
from .load.torque import FollowerTorque, Torque, TorquePair
from .material.elastic import BlatzKo, LinearElastic, NeoHooke, SaintVenantKirchhoff
from .material.material import Material
from .material.rubber import Gent, MooneyRivlin, Ogden, Yeoh
from .material.tissue import HolzapfelGasserOgden
from .material.user_material import UserMaterial
from .measure.contact_probes import ContactArea, ContactForce, ContactGap, ContactPressure
from .measure.flow_probes import Courant, Divergence, FlowField, FlowForce, FlowRate
from .measure.formula import Formula
from .measure.measures import (
    CentreOfMass,
    Direction,
    DirectorProduct,
    JointCoordinate,
    Offset,
    Position,
    Separation,
    SquaredDistance,
)
from .measure.reactions import ReactionForce, ReactionTorque, reaction
from .measure.solid_probes import (
    Displacement,
    Extreme,
    FieldAt,
    SectionForce,
    SectionTorque,
    SupportForce,
    SupportTorque,
    Velocity,
    Volume,
)
from .mesh.faces import Faces
from .mesh.generate import (
    BoxMesh,
    CylinderMesh,
    HollowCylinderMesh,
    HollowTorusMesh,
    QuadrilateralMesh,
    RectangleMesh,
    SphereMesh,
)
from .mesh.mesh import Mesh
from .mesh.mesh_file import MeshFile
from .model.term import Term
from .results.result import Result
from .scheme.schemes import (
    BDF2,
    BackwardEuler,
    EnergyMomentum,
    GeneralizedAlpha,
    Midpoint,
    Scheme,
    VariationalMidpoint,
)
from .study.study import Study
from .system.newton import Newton, StepFailure
from .system.system import System
from .user.servo import Servo, ServoInputs
from .user.terms import Constraint, GeneralizedForce, Potential, UserTerm

__all__ = [
    "BDF2",
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
    "ContactGap",
    "ContactPressure",
    "Courant",
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
    "Divergence",
    "ElasticFoundation",
    "EnergyMomentum",
    "Extreme",
    "Faces",
    "FieldAt",
    "Fixed",
    "FlowField",
    "FlowForce",
    "FlowRate",
    "Fluid",
    "FluidTraction",
    "FollowerForce",
    "FollowerTorque",
    "Force",
    "Formula",
    "FreeSlip",
    "Gear",
    "GeneralizedAlpha",
    "GeneralizedForce",
    "Gent",
    "Gravity",
    "Ground",
    "HollowCylinderMesh",
    "HollowTorusMesh",
    "HolzapfelGasserOgden",
    "Immersed",
    "ImmersedBody",
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
    "NoSlip",
    "Obstacle",
    "Offset",
    "Ogden",
    "Outlet",
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
    "VelocityBoundary",
    "VisvivaError",
    "Volume",
    "Yeoh",
    "arc_length",
    "equilibrium",
    "march",
    "modes",
    "quasi_static",
    "reaction",
    "simulate",
]

__version__: str
