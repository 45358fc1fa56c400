# Public names, and where they are: each module is loaded when one of its names is first used.
from .analysis.adaptive import Adaptive
from .analysis.alternate import AlternateMinimization
from .analysis.arc_length import ArcLength, arc_length
from .analysis.buckling import Buckling, buckling
from .analysis.crack_control import CrackControl
from .analysis.eigenmodes import Modes, modes
from .analysis.load_steps import NoEquilibrium, Static, quasi_static
from .analysis.march import march, simulate
from .analysis.relaxation import equilibrium
from .base.errors import InputError, RunError, VisvivaError
from .base.threads import use_threads
from .base.timefunction import TimeFunction
from .body.beam import Beam
from .body.coupling import DistributedCoupling, RigidCoupling
from .body.extensible_shell import ExtensibleShell
from .body.plane_beam import PlaneBeam
from .body.point_mass import Ground, PointMass
from .body.polygon_section import PolygonSection
from .body.profiles import BoxSection, ISection, RectangleSection, TubeSection
from .body.rigid import RigidBody
from .body.section import GivenSection, UserSection
from .body.shape import Box, Capsule, Cone, Cylinder, Sphere, SurfaceMesh
from .body.shell import Shell
from .body.shell_section import HomogeneousSection, Laminate, Ply
from .body.solid import Solid
from .body.solid_section import SolidLaminate, SolidLayer, SolidSection
from .body.spline_solid import SplineSolid
from .body.viscoelastic_solid import ViscoelasticSolid
from .contact.contact import Contact
from .contact.obstacle import Obstacle, Plane
from .contact.tying import Tie
from .flow.boundary import FreeSlip, NoSlip, VelocityBoundary
from .flow.fluid import Fluid
from .flow.immersed import Immersed
from .flow.immersed_body import ImmersedBody
from .flow.immersed_thin import ImmersedThin
from .flow.opening import FluidTraction, Outlet
from .joint.higher import Gear, RackAndPinion, RopeOverWinch
from .joint.joint import Joint
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
from .linear.petsc import Petsc
from .linear.staggered import Staggered
from .load.bushing import Bushing
from .load.distributed import BodyForce
from .load.drive import JointDamper, JointForce, JointSpring, Motor
from .load.edge_moment import EdgeMoment
from .load.force import FollowerForce, Force
from .load.gravity import Gravity
from .load.line_load import LineLoad
from .load.periodic_faces import PeriodicFaces
from .load.rotating_frame import RotatingFrame
from .load.spring import Damper, Spring
from .load.support import Clamped, Fixed, Prescribed, SymmetryPlane
from .load.surface_loads import ElasticFoundation, Pressure, Traction
from .load.thermal_strain import ThermalStrain
from .load.torque import FollowerTorque, SemitangentialTorque, Torque, TorquePair
from .material.branch import WLF, Arrhenius, MaxwellBranch, prony
from .material.elastic import BlatzKo, LinearElastic, NeoHooke, SaintVenantKirchhoff
from .material.material import Material
from .material.rubber import Gent, Hencky, MooneyRivlin, Ogden, Yeoh
from .material.tissue import HolzapfelGasserOgden
from .material.user_material import UserMaterial
from .measure.beam_probes import Resultants
from .measure.contact_probes import ContactArea, ContactForce, ContactGap, ContactPressure
from .measure.flow_probes import Courant, Divergence, FlowField, FlowForce, FlowRate, WallShear
from .measure.formula import Formula
from .measure.fracture_probes import CrackArea, CrackEnergy, CrackTip
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
from .measure.motion_probes import AngularVelocity, JointRate, Power
from .measure.phase_probes import DomainSize, InterfaceArea, PhaseEnergy, PhaseVolume
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
from .measure.thermal_probes import HeatFlow, TemperatureAt
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
from .mesh.lines import ArcMesh, LineMesh
from .mesh.mesh import Mesh
from .mesh.mesh_file import MeshFile
from .mesh.spline import SplineBox, SplinePatch
from .mesh.spline_joined import SplinePatches
from .model.form import dot
from .model.term import Term
from .output.pictures import Pictures
from .output.reader import StoredRun, read
from .phase.allen_cahn import AllenCahn
from .phase.cahn_hilliard import CahnHilliard
from .phase.exclusion import Exclusion
from .phase.fracturing_solid import FracturingSolid
from .phase.free_energy import DoubleWell, FloryHuggins, PolynomialEnergy, RegularSolution, UserFreeEnergy
from .phase.mixture_solid import MixtureSolid
from .phase.mobility import ArrheniusMobility, DegenerateMobility, UserMobility
from .phase.phase_boundaries import ConcentrationSource, PrescribedConcentration, Wetting
from .phase.spline_mixture import SplineMixtureSolid
from .phase.thermal_fracturing_solid import ThermalFracturingSolid
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
from .study.run import run
from .study.study import Study
from .system.newton import Newton, StepFailure
from .system.system import System
from .thermal.boundaries import Convection, HeatFlux, HeatSource, PrescribedTemperature, Radiation
from .thermal.fluid_heat import FluidHeat
from .thermal.heat import Heat, UserHeat
from .thermal.heat_contact import HeatContact
from .thermal.heat_exchange import HeatExchange
from .thermal.heat_tie import HeatTie
from .thermal.immersed_heat import ImmersedHeat
from .thermal.lumps import HeatStore
from .thermal.thermal_beam import ThermalBeam
from .thermal.thermal_body import ThermalBody
from .thermal.thermal_shell import ThermalShell
from .thermal.thermal_spring import ThermalSpring
from .thermal.thermoelastic_solid import ThermoelasticSolid
from .thermal.thermoviscoelastic_solid import ThermoviscoelasticSolid
from .user.servo import Servo, ServoInputs
from .user.terms import Constraint, GeneralizedForce, Potential, UserTerm

__all__ = [
    "BDF2",
    "WLF",
    "Adaptive",
    "AllenCahn",
    "AlternateMinimization",
    "AngularVelocity",
    "ArcLength",
    "ArcMesh",
    "Arrhenius",
    "ArrheniusMobility",
    "Automatic",
    "BackwardEuler",
    "Beam",
    "BlatzKo",
    "BodyForce",
    "Box",
    "BoxMesh",
    "BoxSection",
    "Buckling",
    "Bushing",
    "CahnHilliard",
    "Capsule",
    "CentreOfMass",
    "Clamped",
    "ConcentrationSource",
    "Cone",
    "Constraint",
    "Contact",
    "ContactArea",
    "ContactForce",
    "ContactGap",
    "ContactPressure",
    "Convection",
    "Courant",
    "CrackArea",
    "CrackControl",
    "CrackEnergy",
    "CrackTip",
    "Cylinder",
    "CylinderMesh",
    "Cylindrical",
    "Damper",
    "DegenerateMobility",
    "Direct",
    "Direction",
    "DirectorProduct",
    "Displacement",
    "Distance",
    "DistributedCoupling",
    "Divergence",
    "DomainSize",
    "DoubleWell",
    "EdgeMoment",
    "ElasticFoundation",
    "EnergyMomentum",
    "Exclusion",
    "ExtensibleShell",
    "Extreme",
    "Faces",
    "FieldAt",
    "Fixed",
    "FloryHuggins",
    "FlowField",
    "FlowForce",
    "FlowRate",
    "Fluid",
    "FluidHeat",
    "FluidTraction",
    "FollowerForce",
    "FollowerTorque",
    "Force",
    "Formula",
    "FracturingSolid",
    "FreeSlip",
    "Gear",
    "GeneralizedAlpha",
    "GeneralizedForce",
    "Gent",
    "GivenSection",
    "Gravity",
    "Ground",
    "Heat",
    "HeatContact",
    "HeatExchange",
    "HeatFlow",
    "HeatFlux",
    "HeatSource",
    "HeatStore",
    "HeatTie",
    "Hencky",
    "HollowCylinderMesh",
    "HollowTorusMesh",
    "HolzapfelGasserOgden",
    "HomogeneousSection",
    "ISection",
    "Immersed",
    "ImmersedBody",
    "ImmersedHeat",
    "ImmersedThin",
    "InputError",
    "InterfaceArea",
    "Iterative",
    "Joint",
    "JointCoordinate",
    "JointDamper",
    "JointForce",
    "JointRate",
    "JointSpring",
    "Laminate",
    "LineLoad",
    "LineMesh",
    "LinearElastic",
    "Material",
    "MaxwellBranch",
    "Mesh",
    "MeshFile",
    "Midpoint",
    "MixtureSolid",
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
    "PeriodicFaces",
    "Petsc",
    "PhaseEnergy",
    "PhaseVolume",
    "Pictures",
    "Planar",
    "Plane",
    "PlaneBeam",
    "Ply",
    "PointMass",
    "PointOnLine",
    "PointOnPlane",
    "PolygonSection",
    "PolynomialEnergy",
    "Position",
    "Potential",
    "Power",
    "Prescribed",
    "PrescribedConcentration",
    "PrescribedTemperature",
    "Pressure",
    "Prismatic",
    "QuadrilateralMesh",
    "RackAndPinion",
    "Radiation",
    "ReactionForce",
    "ReactionTorque",
    "RectangleMesh",
    "RectangleSection",
    "RegularSolution",
    "Result",
    "Resultants",
    "Revolute",
    "Rigid",
    "RigidBody",
    "RigidCoupling",
    "RopeOverWinch",
    "RotatingFrame",
    "RunError",
    "SaintVenantKirchhoff",
    "Scheme",
    "Screw",
    "SectionForce",
    "SectionTorque",
    "SemitangentialTorque",
    "Separation",
    "Servo",
    "ServoInputs",
    "Shell",
    "Solid",
    "SolidLaminate",
    "SolidLayer",
    "SolidSection",
    "Sphere",
    "SphereMesh",
    "Spherical",
    "SplineBox",
    "SplineMixtureSolid",
    "SplinePatch",
    "SplinePatches",
    "SplineSolid",
    "Spring",
    "SquaredDistance",
    "Staggered",
    "Static",
    "StepFailure",
    "StoredRun",
    "Study",
    "SupportForce",
    "SupportTorque",
    "SurfaceMesh",
    "SymmetryPlane",
    "System",
    "TemperatureAt",
    "Term",
    "ThermalBeam",
    "ThermalBody",
    "ThermalFracturingSolid",
    "ThermalShell",
    "ThermalSpring",
    "ThermalStrain",
    "ThermoelasticSolid",
    "ThermoviscoelasticSolid",
    "Tie",
    "TimeFunction",
    "Torque",
    "TorquePair",
    "Traction",
    "TubeSection",
    "Universal",
    "UserFreeEnergy",
    "UserHeat",
    "UserMaterial",
    "UserMobility",
    "UserSection",
    "UserTerm",
    "VariationalMidpoint",
    "Velocity",
    "VelocityBoundary",
    "ViscoelasticSolid",
    "VisvivaError",
    "Volume",
    "WallShear",
    "Wetting",
    "Yeoh",
    "arc_length",
    "buckling",
    "dot",
    "equilibrium",
    "march",
    "modes",
    "prony",
    "quasi_static",
    "reaction",
    "read",
    "run",
    "simulate",
    "use_threads",
]

__version__: str
