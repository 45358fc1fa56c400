"""Shells that conduct heat: temperatures linear or quadratic through the thickness."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass as plain_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass

from visviva.base.errors import InputError
from visviva.body.extensible_shell import ExtensibleShell, Stack
from visviva.body.mesh_points import FacePoints, Points
from visviva.body.shell_layers import N_RAW
from visviva.body.touching import looks_up
from visviva.component.component import Component, settings
from visviva.component.values import NumberAtPlace
from visviva.material.material import Material
from visviva.mesh.cells import CELLS
from visviva.mesh.faces import Faces
from visviva.model.entropies import PRODUCED
from visviva.model.field import Role
from visviva.model.points import Group, PhysicsKind, add_points
from visviva.thermal.carrier import EntropyInput, GivenTemperatures, HeatCarrier, Law, known_part
from visviva.thermal.celsius import refuse_below_zero
from visviva.thermal.heat import Heat
from visviva.thermal.held_step import HeldStep
from visviva.thermal.projection import Projected, Projection
from visviva.thermal.thermoelastic_checks import bulk, strained_at_the_start

if TYPE_CHECKING:
    from visviva.model.model import Model

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
N_STRAINS = 23
"""Of the strain map: those of a layer, entropy and temperature with gradients."""
UNSTRAINED = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
"""Components of C."""
ROUNDS = 30
"""At most, of Newton's method for entropies at the start."""


@plain_dataclass(frozen=True, kw_only=True)
class ThroughThickness(Points):
    """Quadrature points in the volume of a shell, at heights `share` (q,) from -1 at the lower face to 1."""

    share: Array


@dataclass(config=settings, eq=False, kw_only=True)
class ThermalShell(ExtensibleShell, HeatCarrier):
    """A shell of any material in space whose temperature is linear or quadratic through the thickness.

    Takes the arguments of `ExtensibleShell`, with ``formulation="displacement"``, and

    Parameters
    ----------
    heat : Heat
        Of all layers; its conductivity is that of the reference.
    temperature : float, expression in x, y, z, or function of reference positions (n, 3) with values (n,), optional
        Absolute, at the start; by default the reference of `heat`.
    difference : float, expression in x, y, z, or function of reference positions (n, 3) with values (n,)
        Temperature of the upper face less that of the lower one, at the start.
    profile : {"linear", "quadratic"}
        Through the thickness; quadratic ones, as those of sides that heat flows through differently, need a section
        with three points at least.

    Raises
    ------
    InputError
        For temperatures not above absolute zero, for materials that are not of finite strains or of the core, for
        sections that are not alike or have fewer points than the profile has coefficients.

    Notes
    -----
    Nodes have two entropies and two temperatures, the mean through the thickness and half the difference of the faces,
    and with quadratic profiles a third, the factor of ``zeta^2 - 1/3`` with zeta from -1 to 1; energy and both laws are
    those of `ThermoelasticSolid`, at every point of every layer. Heat comes in through the sides
    'upper' and 'lower' by `HeatFlux`, `Convection` and `Radiation`, per area of the side itself.
    `HeatSource` is per volume, at every point of every layer.
    `PrescribedTemperature` holds nodes at one temperature through the thickness.

    Examples
    --------
    >>> import visviva as vv
    >>> steel = vv.SaintVenantKirchhoff(young=210e9, poisson=0.3)
    >>> plate = vv.ThermalShell(
    ...     mesh=vv.RectangleMesh(size=(1, 1), counts=(4, 4)),
    ...     section=vv.SolidSection(material=steel, thickness=0.02, density=7850.0),
    ...     heat=vv.Heat(conductivity=50.0, capacity=3.6e6, expansion=1.2e-5),
    ...     difference=20.0,
    ... )
    >>> sun = vv.HeatFlux(body=plate, faces="upper", flux=1e3)
    >>> system = vv.System([plate, sun])
    >>> float(plate.face_temperatures(system.x)[0, 1].round())
    303.0
    """

    heat: Heat
    temperature: NumberAtPlace | None = None
    difference: NumberAtPlace = 0.0
    profile: Literal["linear", "quadratic"] = "linear"
    balances_entropy = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._refuse_others()
        n, X = self.grid.n_nodes, self.points
        given = self.heat.reference if self.temperature is None else self.temperature
        middle = given(X.copy()) if callable(given) else given
        apart = self.difference(X.copy()) if callable(self.difference) else self.difference
        self.start_temperatures = np.array(np.broadcast_to(np.asarray(middle, dtype=float), n))
        self._start_halves = 0.5 * np.array(np.broadcast_to(np.asarray(apart, dtype=float), n))
        refuse_below_zero(self.label, self.start_temperatures - np.abs(self._start_halves))
        sides = self.start_temperatures[:, None] + self._start_halves[:, None] * np.array([-1, 1])
        if beyond := self.heat.beyond_slopes(sides.ravel()):
            raise InputError(f"{self.label}: {beyond}")

    def _refuse_others(self) -> None:
        if self.formulation != "displacement":
            raise InputError(
                f"{self.label}: formulation = {self.formulation!r} does not conduct heat; take 'displacement'"
            )
        if self.kinks != "refused":
            raise InputError(
                f"{self.label}: kinks = {self.kinks!r}: faces of parts that meet there have temperatures of their own; "
                "give each part a ThermalShell, and join them by Tie and HeatTie"
            )
        for material in self._materials():
            if material.small or material.energy is not None:
                raise InputError(
                    f"{self.label}: {type(material).__name__} is no material of finite strains of the core"
                )
        if len(self._stacks) > 1:
            raise InputError(
                f"{self.label}: its sections or types of cells are not alike; give each a ThermalShell of its own"
            )
        points = len(self._stacks[0].through.heights)
        if points < self._n_modes:
            raise InputError(
                f"{self.label}: a {self.profile} profile of its temperature needs {self._n_modes} points through the "
                f"thickness, and its section has {points}; give it points={self._n_modes}"
            )

    @property
    def _n_modes(self) -> int:
        return 3 if self.profile == "quadratic" else 2

    def _shapes(self, share: Array) -> Array:
        """Shapes (modes, n) of the profile at heights (n,) from -1 to 1; the first is the mean."""
        return np.stack([np.ones_like(share), share, share**2 - 1 / 3][: self._n_modes])

    def _materials(self) -> list[Material]:
        return [layer.material for stack in self._stacks for layer in stack.section.layers]

    def remarks(self) -> list[str]:
        strained = strained_at_the_start(
            self.label, self.heat, max(map(bulk, self._materials())), self.start_temperatures
        )
        return [*super().remarks(), *strained]

    # --- what it contributes -------------------------------------------------------------------------------
    def declare(self, model: Model) -> None:
        super().declare(model)
        T, half, heat = self.start_temperatures, self._start_halves, self.heat
        warm = np.column_stack([T, half, np.zeros((len(T), self._n_modes - 2))])
        modes = self._start_entropies(warm)
        scale, least = heat.stores.c, known_part(T, heat.reference)
        self.entropy = model.field(self, "entropy", modes, role=Role.CONTENT, scale=scale, least=least)
        self.algorithmic = model.field(self, "temperature", warm, role=Role.TEMPERATURE, scale=heat.reference)

    def _start_entropies(self, modes: Array) -> Array:
        """Entropies (n, modes) whose temperatures have these modes (n, modes), in the mean square of the points."""
        through, shapes = self._stacks[0].through, self._shapes(self._share(self._stacks[0]))
        weighted, given = through.weights * shapes, modes @ shapes
        gram = np.linalg.inv(weighted @ shapes.T)
        s = self.heat.start_entropy(given.ravel()).reshape(given.shape) @ weighted.T @ gram
        for _ in range(ROUNDS):
            T, slope = np.empty_like(given), np.empty_like(given)
            for k, layer in enumerate(through.layers):
                at = s @ shapes[:, k]
                small = 1e-6 * self.heat.stores.c
                T[:, k], more = (
                    self.heat.respond(layer.material, np.tile(UNSTRAINED, (len(at), 1)), at + by)[0]
                    for by in (0.0, small)
                )
                slope[:, k] = (more - T[:, k]) / small
            off = (given - T) @ weighted.T
            s = (
                s
                + np.linalg.solve(np.einsum("ak,bk,nk->nab", weighted, shapes, slope), off[..., None])[..., 0]
            )
            if np.abs(off @ gram).max() < 1e-13 * np.abs(given).max():
                return np.asarray(s)
        raise InputError(
            f"{self.label}: no entropies are found with the temperatures given, from {given.min():.6g} to "
            f"{given.max():.6g}: let them differ less through the thickness, or give a capacity without a hump there"
        )

    def _modes(self, nodes: Ints, first: int) -> Ints:
        """Unknowns (m, modes k) of the means of nodes, then of the halves of differences and so on."""
        return np.hstack([first + self._n_modes * nodes + i for i in range(self._n_modes)])

    def contribute(self, model: Model) -> None:
        super().contribute(model)
        means = np.asarray(self.entropy.unknowns)[:: self._n_modes]  # with other modes between them
        account = model.account(self, "conduction", PRODUCED)
        model.entropies.store(np.asarray(self.entropy.unknowns), self._content, means, account, self._terms)

    @property
    def _content(self) -> Array:
        """Integrals (modes n,) of the shape functions, as their unknowns are numbered."""
        (stack,), total = self._stacks, np.zeros(self.entropy.size)
        nodes = stack.surface.cells[stack.cells]
        volume, N = stack.layers.volume.reshape(len(nodes), -1), self._scalar_weights(stack)[..., 0]
        np.add.at(total, self._modes(nodes, 0), np.einsum("mq,mqn->mn", volume, N))
        return total

    def _added(self, model: Model, stack: Stack, own: Ints) -> Any:
        (m, n_s, n_k), nodes = stack.layers.volume.shape, stack.surface.cells[stack.cells]
        scalar = self._scalar_weights(stack)
        groups = [
            *self._placed(stack, own),
            *(Group(self._modes(nodes, f.start), scalar) for f in (self.entropy, self.algorithmic)),
        ]
        reference = np.zeros((m, n_s, n_k, N_STRAINS))
        reference[..., :N_RAW] = stack.layers.reference
        q = n_s * n_k
        return add_points(
            model,
            self,
            PhysicsKind.HEATED_LAYER,
            groups,
            stack.layers.volume.reshape(m, q),
            self._heated_parameters(stack).reshape(m, q, -1),
            reference.reshape(m, q, -1),
        )

    def _share(self, stack: Stack) -> Array:
        """Heights (k,) from -1 at the lower face to 1 at the upper one."""
        height = stack.through.heights - stack.section.offset
        return np.asarray(2 * height / stack.section.thickness_of_all)

    def _scalar_weights(self, stack: Stack) -> Array:
        """Values and gradients (m, q, n, 4) of the n modes of nodes along the axes of the section."""
        surface, z, share = stack.surface, stack.through.heights, self._share(stack)
        N, dN = CELLS[surface.kind].N_dN(surface.rule[0])
        nodes = surface.cells[stack.cells]
        d = surface.directors[nodes]
        x = surface.points[nodes][:, None] + z[:, None, None] * d[:, None]
        tangents = np.einsum("mkna,snb->mskba", x, dN)
        across = np.broadcast_to(np.einsum("mna,sn->msa", d, N)[:, :, None], (*tangents.shape[:3], 3))
        axes = surface.axes[stack.cells]
        frame = np.concatenate([axes, np.cross(axes[..., :1, :], axes[..., 1:, :])], axis=2)
        J = np.einsum("mskba,msia->mskbi", np.concatenate([tangents, across[..., None, :]], axis=3), frame)
        back = np.linalg.inv(J)  # [i, b]
        shapes, steep = self._shapes(share), np.stack([0 * share, 1 + 0 * share, 2 * share][: self._n_modes])
        by_place = np.zeros(
            (len(z), len(N), self._n_modes, N.shape[1], 3)
        )  # by the cell's coordinates and the height
        by_place[..., :2] = np.einsum("ik,snb->ksinb", shapes, dN)
        by_place[..., 2] = np.einsum("ik,sn->ksin", 2 / stack.section.thickness_of_all * steep, N)
        n = N.shape[1] * self._n_modes
        weights = np.empty((*tangents.shape[:3], n, 4))
        weights[..., 0] = np.einsum("ik,sn->skin", shapes, N).reshape(len(N), len(z), -1)
        slopes = by_place.reshape(len(z), len(N), n, 3)
        weights[..., 1:] = np.einsum("mskib,ksnb->mskni", back, slopes)
        return weights.reshape(len(nodes), -1, n, 4)

    def _heated_parameters(self, stack: Stack) -> Array:
        """Of the energy at the points (m, s, k, p), see ``visviva/point/heat_stores.hpp``."""
        m, s, k = stack.layers.volume.shape
        wide = np.zeros((m, s, k, 7, N_RAW + 1))
        wide[..., :6, :N_RAW], wide[..., 6, N_RAW] = stack.layers.turn, 1.0
        rows = np.array([self.heat.parameters(layer.material) for layer in stack.through.layers])
        return np.concatenate([wide.reshape(m, s, k, -1), np.broadcast_to(rows, (m, s, *rows.shape))], axis=3)

    def hold_temperatures(self, model: Model, owner: Component, given: GivenTemperatures) -> None:
        now, nodes = given.values(0.0), given.nodes
        refuse_below_zero(owner.label, now)
        n, zero = self._n_modes, np.zeros((len(now), self._n_modes - 1))
        self.entropy.values.reshape(-1, n)[nodes] = np.column_stack([self.heat.start_entropy(now), zero])
        self.algorithmic.values.reshape(-1, n)[nodes] = np.column_stack([now, zero])
        model.refresh(self.entropy)
        model.refresh(self.algorithmic)
        supply = model.multipliers(owner, "supply", n * len(nodes), instantaneous=False)
        of_modes = [
            np.concatenate([f.start + n * nodes + i for i in range(n)])
            for f in (self.entropy, self.algorithmic)
        ]
        table = np.asarray(np.stack([*of_modes, np.asarray(supply.unknowns)], axis=1), dtype=np.int32)
        values, found = (
            (lambda t: np.concatenate([given.values(t), zero.T.ravel()])),
            (lambda x: self._profiles(x)[nodes].T.ravel()),
        )
        model.term(owner, HeldStep(table, values, found))

    def heated_points(self, faces: Faces) -> Iterator[FacePoints]:
        """Of sides on these themselves, whose areas differ from that of the middle where the shell is curved."""
        return self.face_points(faces, on_sides=True)

    def invalid(self, x: Array) -> str:
        """Temperatures of the step below absolute zero, or at which slopes leave nothing positive."""
        if found := super().invalid(x):
            return found
        beyond = self.heat.beyond_slopes(self.temperatures_across(x).ravel())
        return f"{self.label}: {beyond}" if beyond else ""

    def profiles(self) -> Array:
        return self._shapes(np.array([-1.0, 0.0, 1.0])).T

    def heat_modes(self, faces: Faces) -> Array:
        """Of its upper or its lower side; through edges the mean.

        Raises
        ------
        InputError
            For faces of several sides, which have no temperature in common.
        """
        signs = {sign for kind in faces.cells for sign in self._signs(kind, faces)}
        if len(signs) > 1:
            raise InputError(
                f"{self.label}: these faces are of both of its sides, or of a side and edges, which differ in "
                "temperature; take 'upper', 'lower' and edges each for itself"
            )
        return np.array([1.0, *self._at_side(signs.pop())])

    def _signs(self, kind: str, faces: Faces) -> Array:
        """1 of faces (m,) of the upper side, -1 of the lower one, 0 of edges."""
        nodes = faces.cells[kind]
        if CELLS[kind].dimension == 1:
            return np.zeros(len(nodes))
        return np.where(looks_up(nodes, self.cells_of(kind, faces.owners[kind])), 1.0, -1.0)

    def source_points(self) -> Iterator[Points]:
        (stack,) = self._stacks
        surface, z = stack.surface, stack.through.heights
        N, nodes = CELLS[surface.kind].N(surface.rule[0]), surface.cells[stack.cells]
        x = surface.points[nodes][:, None] + z[:, None, None] * surface.directors[nodes][:, None]
        yield ThroughThickness(
            nodes=nodes,
            N=np.repeat(N, len(z), axis=0),
            X=np.einsum("mkna,sn->mska", x, N).reshape(len(nodes), -1, 3),
            size=stack.layers.volume.reshape(len(nodes), -1),
            share=np.tile(self._share(stack), len(N)),
        )

    def take_heat(self, model: Model, owner: Component, kind: str, points: Points, law: Law) -> None:
        side = np.zeros(len(points.nodes))
        if isinstance(points, FacePoints):
            if points.nodes.shape[1] < 3:
                raise InputError(
                    f"{owner.label}: heat comes into {self.label} through its sides 'upper' and 'lower'"
                )
            d = np.einsum("mkc->mc", self.parts[0].directors[points.nodes])
            side = np.sign(np.einsum("mqc,mc->m", points.normal, d))
        inner = points.share if isinstance(points, ThroughThickness) else np.zeros(len(points.N))
        for sign in np.unique(side):
            some = side == sign
            nodes = points.nodes[some]
            unknowns = np.hstack([self._modes(nodes, f.start) for f in (self.entropy, self.algorithmic)])
            part = Points(
                nodes=nodes,
                N=np.hstack([shape[:, None] * points.N for shape in self._shapes(inner + sign)]),
                X=points.X[some],
                size=points.size[some],
            )
            model.term(owner, EntropyInput(kind, np.asarray(unknowns, dtype=np.int32), part, law))

    def _at_side(self, sign: float) -> Array:
        """Modes behind the mean on the upper side (1), on the lower one (-1), or in the mean (0)."""
        return self._shapes(np.array([sign]))[1:, 0] if sign else np.zeros(self._n_modes - 1)

    def temperature_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return np.asarray(self.algorithmic.start + self._n_modes * np.asarray(nodes), dtype=np.int32)

    def balance_unknowns(self, nodes: Ints) -> NDArray[np.int32]:
        return np.asarray(self.entropy.start + self._n_modes * np.asarray(nodes), dtype=np.int32)

    # --- what it shows -------------------------------------------------------------------------------------
    def _responses(self, x: Array) -> tuple[Array, Array, Array]:
        """Of the one stack: temperatures (m, s, k), stresses (m, s, k, 6) and volumes (m, s, k)."""
        stack = self._stacks[0]
        C = self.green(x)[0]
        m, s, k = C.shape[:3]
        nodes = stack.surface.cells[stack.cells]
        modes = x[self._modes(nodes, self.entropy.start)]
        entropy = np.einsum("mqn,mn->mq", self._scalar_weights(stack)[..., 0], modes).reshape(m, s, k)
        T, S = np.empty((m, s, k)), np.empty_like(C)
        for j, layer in enumerate(stack.through.layers):
            flat = C[:, :, j].reshape(-1, 6)
            found = self.heat.respond(layer.material, flat, entropy[:, :, j].ravel())
            T[:, :, j], S[:, :, j] = found[0].reshape(m, s), found[1].reshape(m, s, 6)
        return T, S, stack.layers.volume

    def stresses(self, x: Array) -> list[Array]:
        return [self._responses(x)[1]]

    @cached_property
    def _projection(self) -> Projection:
        stack = self._stacks[0]
        nodes = stack.surface.cells[stack.cells]
        shapes, sizes = self._scalar_weights(stack)[..., 0], stack.layers.volume.reshape(len(nodes), -1)
        parts = [Projected(self._modes(nodes, 0), shapes, sizes)]
        return Projection(self._n_modes * self.grid.n_nodes, parts)

    def _profiles(self, x: Array) -> Array:
        """Modes (n, modes) of the temperatures of strains and entropies."""
        T, _, _ = self._responses(x)
        return self._projection([T.reshape(len(T), -1)]).reshape(-1, self._n_modes)

    def face_temperatures(self, x: Array) -> Array:
        """Temperatures (n, 2) of the lower and the upper face at the nodes, of strains and entropies."""
        return self._profiles(x) @ self._shapes(np.array([-1.0, 1.0]))

    def temperatures(self, x: Array) -> Array:
        """Temperatures (n,) of the middle at the nodes, at the unknowns `x` of the system."""
        return np.asarray(self._profiles(x) @ self._shapes(np.zeros(1))[:, 0])

    def total_entropy(self, x: Array) -> float:
        """Of the whole body at the unknowns `x` of the system."""
        return float(self._content @ x[self.entropy.start : self.entropy.start + self.entropy.size])

    def _carried(self) -> Mapping[str, Callable[[Array], Array]]:
        return {**super()._carried(), "temperature": self.temperatures}
