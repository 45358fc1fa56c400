"""Shells whose directors stretch, with the energy of any material in space across their thickness."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva import _core
from visviva.base.errors import InputError
from visviva.body.formulation import STIFFEST
from visviva.body.shell import FIELDS, Shell, at_their_angles
from visviva.body.shell_layers import (
    CORNERS,
    N_RAW,
    Layers,
    at_corners,
    layers,
    of_components,
    raw_strains,
    turned,
)
from visviva.body.shell_stress import second_piola
from visviva.body.shell_surface import ShellSurface
from visviva.body.solid_section import SolidLaminate, SolidSection, Through
from visviva.component.component import settings
from visviva.material.material import OF_BLATZ_KO, Material
from visviva.model.callback import Function
from visviva.model.field import Role
from visviva.model.form import Form, Strain, Vector
from visviva.model.points import Group, PhysicsKind, add_points

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
REST = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])


class Stack(NamedTuple):
    """Cells (m,) of one type and one section, by their numbers in their surface and among all, and their points."""

    surface: ShellSurface
    section: SolidSection | SolidLaminate
    cells: Ints
    numbers: Ints
    through: Through
    angles: Array
    layers: Layers


@dataclass(config=settings, eq=False, kw_only=True)
class ExtensibleShell(Shell):
    """A surface with a director of free length at each node: thick or thin, of any material in space.

    Parameters
    ----------
    mesh : of quadrilaterals of four nodes and triangles of three
    kinks : {'refused', 'rigid', 'hinged'}
        As for `Shell`; directors of rigid ones keep their angles and stretch alike, as if they were one.
    first, slits, velocity, angular_velocity
        As for `Shell`.
    section : SolidSection or SolidLaminate, or one for each cell
    formulation : {'displacement', 'mixed'}
        'mixed' has a pressure in each cell, even or linear across the thickness, for rubber and other nearly or
        exactly incompressible materials.

    Notes
    -----
    Places are ``phi + z d``, and the strain is ``C - I`` of all of them, through the height z, with that across the
    thickness enhanced by a part linear in z (Buechter, Ramm & Roehl 1994). Transverse shear strains are taken from the
    middles of the edges (Dvorkin & Bathe 1984, Lee & Bathe 2004), strains across from the nodes (Betsch & Stein 1995).
    The stress is that of the material in space: nothing is assumed of it. Triangles keep all of their shear stiffness,
    which `Shell` takes from them, as nothing else holds directors upright under pressures: thin plates need fine ones.

    Examples
    --------
    >>> import visviva as vv
    >>> rubber = vv.MooneyRivlin(c10=0.4, c01=0.1, bulk=1e4)
    >>> sheet = vv.RectangleMesh(size=(1, 1), counts=(2, 2))
    >>> section = vv.SolidSection(material=rubber, thickness=0.01)
    >>> shell = vv.ExtensibleShell(mesh=sheet, section=section, formulation="mixed")
    >>> vv.System([shell]).n_coordinates
    54
    """

    section: SolidSection | SolidLaminate | tuple[SolidSection | SolidLaminate, ...]  # type: ignore[assignment]
    formulation: Literal["displacement", "mixed"] = "displacement"

    n_held = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.membrane != "compatible":
            raise InputError(f"{self.label}: membrane='enhanced' is for vv.Shell, whose energy is quadratic")
        others = [part.kind for part in self.parts if part.kind not in CORNERS]
        if others:
            raise InputError(
                f"{self.label}: directors stretch in surfaces of quad4 and tri3 alone: nothing keeps those of "
                f"{', '.join(others)} from locking yet; take vv.Shell for others"
            )
        for stack in self._stacks:
            for layer in stack.section.layers:
                self._refuse_material(layer.material)

    def _refuse_material(self, material: Material) -> None:
        bulk = material.split().bulk if self.formulation == "mixed" else material.lame[0]
        if self.formulation == "mixed" and (material.energy is not None or bulk <= 0):
            raise InputError(
                f"{self.label}: formulation='mixed' needs a material of the package with a volumetric energy, not "
                f"{type(material).__name__}; take 'displacement'"
            )
        if self.formulation == "displacement" and not np.isfinite(bulk):
            raise InputError(
                f"{self.label}: its material {type(material).__name__} is incompressible, which displacements alone "
                "cannot carry; use formulation='mixed'"
            )
        materials = {id(layer.material) for stack in self._stacks for layer in stack.section.layers}
        if material.energy is not None and len(materials) > 1:
            raise InputError(
                f"{self.label}: a material given in Python stands alone in a shell; make every layer of it, or take "
                "materials of the package"
            )

    def invalid(self, x: Array) -> str:
        """Not for turned cells: directors that get short press the material together, which resists."""
        return super(Shell, self).invalid(x)

    # --- sections ------------------------------------------------------------------------------------------
    @cached_property
    def _stacks(self) -> tuple[Stack, ...]:
        """Cells by their type and section."""
        of, found, start = np.array([id(section) for section in self.sections]), [], 0
        for part in self.parts:
            own = of[start : start + len(part.cells)]
            for number in dict.fromkeys(own.tolist()):
                cells = np.flatnonzero(own == number)
                section = self.sections[start + int(cells[0])]
                through = section.through()
                angles = np.array([layer.angle for layer in through.layers])
                points = layers(part, cells, through.heights, through.weights, angles)
                found.append(Stack(part, section, cells, start + cells, through, angles, points))
            start += len(part.cells)
        return tuple(found)

    @property
    def modulus(self) -> float:
        """Largest modulus of an even plane stress."""
        found = []
        for stack in self._stacks:
            for layer in stack.section.layers:
                lam, mu = layer.material.lame
                found.append(4 * mu * (1 - mu / (lam + 2 * mu)))
        return max(found)

    # --- what it contributes -------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        super().declare(model)
        m, more = self.n_cells, 2 if self._condenses else 0
        counts = [(len(part.cells), len(part.rule.weights)) for part in self.parts]
        scale = np.concatenate([np.tile([1.0] * n + [0.0] * more, of) for of, n in counts])
        element = np.repeat(np.arange(m), np.concatenate([np.full(of, n + more) for of, n in counts]))
        own: Any = {"stage": 1, "scale": scale, "element": element}
        inner = model.field(self, "enhanced", np.zeros(len(scale)), role=Role.STATE, **own)
        first = inner.start + np.searchsorted(element, np.arange(m))
        n_own = np.bincount(element) - more
        self._enhanced = [first[s.numbers, None] + np.arange(n_own[s.numbers[0]]) for s in self._stacks]
        self._pressures = (first + n_own)[:, None] + np.arange(more)
        if self.formulation == "mixed" and not self._condenses:
            pressure = model.field(self, "pressure", np.zeros((m, 2)), role=Role.MULTIPLIER, stage=1)
            self._pressures = pressure.start + np.arange(2 * m).reshape(m, 2)

    @property
    def _condenses(self) -> bool:
        """True if pressures are condensed with the enhanced strains: every layer has to be compressible."""
        materials = [layer.material for stack in self._stacks for layer in stack.section.layers]
        soft = all(m.split().bulk <= STIFFEST * m.lame[1] for m in materials)
        return self.formulation == "mixed" and soft

    def hold_lengths(self, model: Model, nodes: Ints) -> None:
        """Directors have no lengths to hold."""

    def contribute(self, model: Model) -> None:
        self._terms = [
            self._added(model, stack, own) for stack, own in zip(self._stacks, self._enhanced, strict=True)
        ]
        self._join(model, self.clamped(model))
        self.add_inertia(model)

    def joined(self, d: list[Vector], reference: Array) -> list[Strain | Form]:
        """Directors of a rigid kink stretch alike, those at a hinge each on its own."""
        return at_their_angles(d, reference, stretch=True) if self.kinks == "rigid" else []

    def _placed(self, stack: Stack, own: Ints) -> list[Group]:
        """Variables of the strain map: positions and directors, and enhanced strains (m, s)."""
        z, (n_s, n_k) = stack.through.heights, stack.layers.volume.shape[1:]
        surface = stack.surface
        places = self.node_unknowns(surface.cells[stack.cells])
        directors = self.turn_unknowns(surface.turns[stack.cells])
        share = (z - stack.section.offset) / stack.section.thickness_of_all
        enhanced = np.zeros((n_s, n_k, n_s, 1))
        enhanced[range(n_s), :, range(n_s), 0] = 2 * share  # each point of the surface has its own
        weights = np.tile(at_corners(surface.kind, z), (n_s, 1, 1))
        return [
            Group(np.hstack([places, directors]), weights, None, True),
            Group(own, enhanced.reshape(n_s * n_k, n_s, 1)),
        ]

    def _added(self, model: Model, stack: Stack, own: Ints) -> Any:
        z, (n_s, n_k) = stack.through.heights, stack.layers.volume.shape[1:]
        share = (z - stack.section.offset) / stack.section.thickness_of_all
        groups = self._placed(stack, own)
        kind, reference = PhysicsKind.LAYER, stack.layers.reference
        if self.formulation == "mixed":
            kind = PhysicsKind.PRESSED_LAYER
            weights = np.tile(np.stack([np.ones(n_k), share], axis=1), (n_s, 1))[:, :, None]
            groups.append(Group(self._pressures[stack.numbers], weights))
            reference = np.concatenate([reference, np.zeros((*reference.shape[:3], 1))], axis=3)
        m, q = len(stack.cells), n_s * n_k
        return add_points(
            model,
            self,
            kind,
            groups,
            stack.layers.volume.reshape(m, q),
            self._parameters(stack).reshape(m, q, -1),
            reference.reshape(m, q, -1),
            energy=self._own_energy(stack),
        )

    def _parameters(self, stack: Stack) -> Array:
        """Of the energy at the points (m, s, k, p), see cpp/visviva/point/layer.hpp."""
        m, s, k = stack.layers.volume.shape
        turn = stack.layers.turn
        constants = np.zeros((k, _core.MATERIAL_PARAMETERS))
        kinds, volume = np.zeros((k, 1)), np.zeros((k, 0))
        if self.formulation == "mixed":
            wide = np.zeros((m, s, k, 7, N_RAW + 1))
            wide[..., :6, :N_RAW], wide[..., 6, N_RAW] = turn, 1.0
            turn, volume = wide, np.zeros((k, 3))
        for j, layer in enumerate(stack.through.layers):
            material = layer.material
            if self.formulation == "mixed":
                kind, values, _, bulk, measure = material.split()
                volume[j] = measure, values[3] if measure == OF_BLATZ_KO else 0.0, 1 / bulk
            else:
                kind, values = material.kind, material.constants()
            kinds[j], constants[j, : len(values)] = int(kind), values
        parts = [kinds, turn.reshape(m, s, k, -1), volume, constants]
        return np.concatenate([np.broadcast_to(p, (m, s, k, p.shape[-1])) for p in parts], axis=3)

    def _own_energy(self, stack: Stack) -> Function | None:
        energy = stack.through.layers[0].material.energy
        if energy is None:
            return None
        label = f"{self.label}: energy of its material"
        return Function(lambda c: energy(c + REST[:, None]), 6, 1, label, origin=REST)

    # --- strains and stresses ------------------------------------------------------------------------------
    def green(self, x: Array) -> list[Array]:
        """Right Cauchy-Green tensors (m, s, k, 6) of each stack, in the directions of the material."""
        phi, directors = self._positions_directors(x)
        found = []
        for stack, own in zip(self._stacks, self._enhanced, strict=True):
            corners = CORNERS[stack.surface.kind]
            d = directors[stack.surface.turns[stack.cells]][:, None, corners]
            at = phi[stack.surface.cells[stack.cells]][:, None, corners]
            at = at + stack.through.heights[:, None, None] * d
            raw = raw_strains(at, np.broadcast_to(d, at.shape))
            change = raw[:, None] - stack.layers.reference
            share = (stack.through.heights - stack.section.offset) / stack.section.thickness_of_all
            change[..., -1] = 2 * share * x[own][:, :, None]
            found.append(np.einsum("mskij,mskj->mski", stack.layers.turn, change) + REST)
        return found

    def stresses(self, x: Array) -> list[Array]:
        """Second Piola-Kirchhoff stresses (m, s, k, 6) of each stack, in the directions of the material."""
        found = []
        for stack, C in zip(self._stacks, self.green(x), strict=True):
            S = np.empty_like(C)
            for k, layer in enumerate(stack.through.layers):
                pressure = self._pressure(stack, k, x)
                S[:, :, k] = second_piola(layer.material, C[:, :, k], pressure)
            found.append(S)
        return found

    def _pressure(self, stack: Stack, k: int, x: Array) -> Array | None:
        """Of the cells (m, 1) at the height k."""
        if self.formulation != "mixed":
            return None
        share = (stack.through.heights[k] - stack.section.offset) / stack.section.thickness_of_all
        return np.asarray(x[self._pressures[stack.numbers]] @ np.array([[1.0], [share]]))

    def resultants_of_parts(self, x: Array) -> list[Array]:
        """Membrane forces, moments and shear forces (m, s, 8) per length of the reference, of its stresses."""
        found = {id(part): np.zeros((*part.areas.shape, 8)) for part in self.parts}
        for stack, S in zip(self._stacks, self.stresses(x), strict=True):
            total = found[id(stack.surface)]
            weight = stack.layers.volume / stack.surface.areas[stack.cells][:, :, None]
            back = of_components(turned(-stack.angles))
            forces = np.einsum("kij,mskj,msk->mski", back, S, weight)
            z = stack.through.heights[:, None]
            total[stack.cells, :, :3] = forces[..., [0, 1, 3]].sum(axis=2)
            total[stack.cells, :, 3:6] = (z * forces[..., [0, 1, 3]]).sum(axis=2)
            total[stack.cells, :, 6:] = forces[..., [5, 4]].sum(axis=2)
        return list(found.values())

    def _widths_at_points(self) -> Mapping[str, int]:
        return {**FIELDS, "thickness": 1}

    def at_points(self, name: str, x: Array) -> Array:
        if name != "thickness":
            return super().at_points(name, x)
        length, rest = (
            np.linalg.norm(self._positions_directors(x)[1], axis=1),
            self.by_cell(lambda s: s.thickness_of_all),
        )
        parts = zip(self.parts, self.by_type(rest), strict=True)
        return np.concatenate([(t[:, None] * (length[part.turns] @ part.N.T)).ravel() for part, t in parts])[
            :, None
        ]
