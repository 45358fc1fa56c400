"""Linear solvers on their own: against SciPy's, and what they say of matrices that cannot be solved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from matrices import Elasticity, block, matrix_of, scaled, shifted, torus, unsymmetric, with_constraints
from numpy.typing import NDArray

import visviva as vv
from visviva import _core
from visviva.analysis.march import prepare
from visviva.linear import choice as linear
from visviva.linear import multigrid
from visviva.linear.choice import Automatic, Choice, Direct, Iterative, Problem
from visviva.system.build import places
from visviva.system.problem import problem_of

Array = NDArray[np.float64]

needs_pardiso = pytest.mark.skipif(bool(linear.missing_pardiso()), reason="oneMKL is not installed")
needs_multigrid = pytest.mark.skipif(not linear.has_multigrid(), reason="PyAMG is not installed")
PARDISO = pytest.param(Direct(library="pardiso"), marks=needs_pardiso, id="pardiso")
EIGEN = pytest.param(Direct(library="eigen"), id="eigen")
MULTIGRID = [
    pytest.param(Iterative(m, "multigrid", tolerance=1e-10), marks=needs_multigrid, id=f"{m}-multigrid")
    for m in ("cg", "gmres", "bicgstab")
]
KRYLOV = [
    pytest.param(Iterative(m, p, tolerance=1e-10, max_iterations=2000), id=f"{m}-{p}")
    for m in ("cg", "gmres", "bicgstab")
    for p in ("none", "diagonal", "block", "incomplete")
]
UNSYMMETRIC = [p for p in KRYLOV + MULTIGRID if not str(p.id).startswith("cg")]


def problem(A: sp.csr_array, **what: Any) -> Problem:
    """What a choice needs to know of a matrix."""
    return Problem(n=A.shape[0], n_entries=A.nnz, **what)


def solver(
    choice: Choice, A: sp.csr_array, body: Elasticity | None = None, multiplier: Array | None = None
) -> Any:
    """A solver for the pattern of a matrix."""
    n = A.shape[0]
    node = np.zeros(0, np.int32) if body is None else body.node
    modes = np.zeros(0) if body is None else np.ascontiguousarray(body.modes)
    flags = np.zeros(n, np.int32) if multiplier is None else multiplier
    row, col = A.indptr.astype(np.int64), A.indices.astype(np.int32)
    return _core.Linear(list(choice.in_order), row, col, node, modes, flags)


def solve(s: Any, A: sp.csr_array, b: Array) -> Array:
    """The solution; both parts must have worked."""
    assert s.factor(A.data), s.message
    x = np.full(A.shape[0], np.nan)
    assert s.solve(b, x), s.message
    return x


def right_hand_side(A: sp.csr_array) -> Array:
    return A @ np.random.default_rng(1).standard_normal(A.shape[0])


def assert_solves(
    options: Any, A: sp.csr_array, body: Elasticity | None, tolerance: float, **what: Any
) -> None:
    """As SciPy's direct solver does."""
    s = solver(options.choose(problem(A, has_modes=body is not None, **what)), A, body)
    b = right_hand_side(A)
    x, y = solve(s, A, b), spla.spsolve(A.tocsc(), b)
    assert np.linalg.norm(A @ x - b) < 1.5 * tolerance * np.linalg.norm(b)
    assert np.linalg.norm(x - y) < 1e4 * tolerance * np.linalg.norm(y)


@pytest.mark.parametrize("options", [PARDISO, EIGEN, *KRYLOV, *MULTIGRID])
@pytest.mark.parametrize("fixed", ["clamped", "symmetry"])
def test_positive_definite(options: Any, fixed: str) -> None:
    """All solvers solve linear elasticity; nodes on symmetry planes have fewer unknowns than others."""
    body = block(6, fixed=fixed)
    tolerance = getattr(options, "tolerance", 1e-14)
    assert_solves(options, body.matrix, body, tolerance, symmetric=True, definite=True)


@pytest.mark.parametrize("options", [PARDISO, EIGEN])
def test_saddle_point(options: Any) -> None:
    """Constraints with zero diagonals, which the pattern does not even hold."""
    A = with_constraints(block(6), 40)
    assert_solves(options, A, None, 1e-12, symmetric=True, definite=True, n_multipliers=40)


@pytest.mark.parametrize("options", [PARDISO, EIGEN, *UNSYMMETRIC])
def test_unsymmetric(options: Any) -> None:
    """General matrices, multigrid on top of rigid motions included."""
    body = block(5)
    assert_solves(options, unsymmetric(body, 0.02), body, getattr(options, "tolerance", 1e-13))


@pytest.mark.parametrize("options", [PARDISO, EIGEN])
def test_units_do_not_matter(options: Any) -> None:
    """Rows and columns of very different size are brought to one size first."""
    body = block(4)
    d = 10.0 ** np.random.default_rng(2).uniform(-8, 8, body.matrix.shape[0])
    A = scaled(body.matrix, d)
    s = solver(options.choose(problem(A, symmetric=True, definite=True)), A)
    x = np.random.default_rng(3).standard_normal(len(d)) / d
    assert np.abs(d * (solve(s, A, A @ x) - x)).max() < 1e-8


@pytest.mark.parametrize("options", [PARDISO, EIGEN])
@pytest.mark.parametrize("definite", [True, False])
def test_unsupported_body_is_singular(options: Any, definite: bool) -> None:
    """Six rigid motions without resistance: no solver may return a solution."""
    body = block(4, fixed="free")
    s = solver(options.choose(problem(body.matrix, symmetric=definite, definite=definite)), body.matrix, body)
    assert not s.factor(body.matrix.data)
    assert 0 <= s.singular_unknown < body.matrix.shape[0]


@needs_pardiso
def test_singular_unknown_is_named() -> None:
    """A motion of one unknown alone is found."""
    A = scaled(block(4).matrix, np.arange(300) != 100.0)
    for definite in (True, False):
        s = solver(Direct(library="pardiso").choose(problem(A, symmetric=True, definite=definite)), A)
        assert not s.factor(A.data)
        assert s.singular_unknown == 100


@needs_multigrid
def test_multigrid_names_rigid_motions() -> None:
    body = block(4, fixed="free")
    choice = Iterative("cg", "multigrid").choose(problem(body.matrix, symmetric=True, definite=True))
    s = solver(choice, body.matrix, body)
    assert not s.factor(body.matrix.data)
    assert "rigid" in s.message


@pytest.mark.parametrize("options", [PARDISO, EIGEN])
def test_matrix_that_is_not_definite_after_all(options: Any) -> None:
    """A state that has lost stability: the next solver takes over and says why."""
    body = block(4)
    lowest = np.linalg.eigvalsh(body.matrix.toarray())
    A = shifted(body.matrix, -0.5 * (lowest[2] + lowest[3]))
    s = solver(options.choose(problem(A, symmetric=True, definite=True)), A)
    b = right_hand_side(A)
    assert s.factor(A.data)
    assert "not positive definite" in s.message
    x = solve(s, A, b)
    assert np.linalg.norm(A @ x - b) < 1e-11 * np.linalg.norm(b)
    assert s.factor(A.data)
    assert s.n_negative in (3, -1)  # -1: LU does not count them


def test_values_live_as_long_as_the_solver() -> None:
    """Where solving fails the next solver factors the values again, which their owner may have let go."""
    body = block(6)
    first = Iterative("cg", "none", tolerance=1e-10, max_iterations=2).choose(problem(body.matrix))
    choices = (*first.in_order[:1], *Direct(library="eigen").choose(problem(body.matrix)).in_order)
    s = solver(replace(first, in_order=choices), body.matrix)
    assert s.factor(body.matrix.data.copy())
    others = [np.full(len(body.matrix.data), np.nan) for _ in range(50)]  # where the values were
    b = right_hand_side(body.matrix)
    x = np.full(len(b), np.nan)
    assert s.solve(b, x)
    assert len(others) == 50
    assert "LU" in s.name
    assert np.linalg.norm(body.matrix @ x - b) < 1e-11 * np.linalg.norm(b)


@needs_pardiso
def test_matrix_that_is_not_symmetric_after_all() -> None:
    A = unsymmetric(block(4), 0.1)
    s = solver(Direct(library="pardiso").choose(problem(A, symmetric=True, definite=True)), A)
    b = right_hand_side(A)
    x = solve(s, A, b)
    assert np.linalg.norm(A @ x - b) < 1e-12 * np.linalg.norm(b)
    assert s.name == "PARDISO, LU"


@pytest.mark.parametrize("options", [PARDISO, EIGEN, *MULTIGRID])
def test_values_change_under_one_analysis(options: Any) -> None:
    """As over the steps of Newton: what is kept serves, or is made anew."""
    body = block(5)
    s = solver(options.choose(problem(body.matrix, symmetric=True, definite=True)), body.matrix, body)
    n = body.matrix.shape[0]
    for stiffening in (1, 1e-2, 30, 1e4):
        d = 1 + (stiffening - 1) * (np.arange(n) > n // 2)
        A = scaled(body.matrix, np.sqrt(d))
        b = right_hand_side(A)
        assert np.linalg.norm(A @ solve(s, A, b) - b) < 1.5e-10 * np.linalg.norm(b)


@needs_pardiso
def test_saddle_point_whose_pivots_change() -> None:
    """Matching was made for other values; the solution is as good as with a new analysis."""
    body = block(5)
    A = with_constraints(body, 30)
    s = solver(Direct(library="pardiso").choose(problem(A, symmetric=True, n_multipliers=30)), A)
    for seed in range(5):
        random = np.random.default_rng(seed)
        d = 10.0 ** random.uniform(-4, 4, A.shape[0])
        B = scaled(A, d)
        b = right_hand_side(B)
        x = solve(s, B, b)
        assert np.linalg.norm((B @ x - b) / d) < 1e-10 * np.linalg.norm(b / d)


@pytest.mark.parametrize("options", [*KRYLOV, *MULTIGRID])
def test_no_convergence_is_said(options: Any) -> None:
    """A solution that misses its tolerance is none."""
    body = block(6)
    few = Iterative(options.method, options.preconditioner, tolerance=1e-12, max_iterations=2)
    s = solver(few.choose(problem(body.matrix, symmetric=True, definite=True)), body.matrix, body)
    x = np.full(body.matrix.shape[0], 7.0)
    assert s.factor(body.matrix.data)
    assert not s.solve(right_hand_side(body.matrix), x)
    assert "no convergence after 2 iterations" in s.message
    assert np.all(x == 7.0)


def test_conjugate_gradients_refuse_an_indefinite_matrix() -> None:
    body = block(4)
    A = shifted(body.matrix, -0.1)
    s = solver(Iterative("cg", "none").choose(problem(A, symmetric=True, definite=True)), A, body)
    assert s.factor(A.data)
    assert not s.solve(right_hand_side(A), np.zeros(A.shape[0]))
    assert "not positive definite" in s.message


@needs_multigrid
def test_aggregates_outlast_the_values_of_the_matrix(monkeypatch: pytest.MonkeyPatch) -> None:
    """New values cost products of matrices only, and what they give depends on nothing earlier."""
    calls, make = [], multigrid.aggregates

    def counted(*args: Any) -> Any:
        calls.append(len(args[0]) - 1)
        return make(*args)

    monkeypatch.setattr(multigrid, "aggregates", counted)
    body = block(8)
    other = scaled(body.matrix, 1 + 0.05 * np.sin(np.arange(body.matrix.shape[0])))
    choice = Iterative("cg", "multigrid", tolerance=1e-9).choose(
        problem(other, symmetric=True, definite=True)
    )
    used, fresh = (solver(choice, body.matrix, body) for _ in range(2))
    b = right_hand_side(other)
    solve(used, body.matrix, b)
    used.forget()
    x = solve(used, other, b)
    assert len(calls) == 1
    assert np.linalg.norm(other @ x - b) < 1e-9 * np.linalg.norm(b)
    assert np.array_equal(x, solve(fresh, other, b))
    assert len(calls) == 2


@needs_multigrid
def test_multigrid_needs_few_iterations_whatever_the_mesh() -> None:
    """Clamped cubes with rigid motions as near-null vectors."""
    iterations = []
    for n in (6, 12):
        body = block(n)
        s = solver(
            Iterative("cg", "multigrid", tolerance=1e-8).choose(
                problem(body.matrix, symmetric=True, definite=True)
            ),
            body.matrix,
            body,
        )
        solve(s, body.matrix, right_hand_side(body.matrix))
        iterations.append(s.iterations)
    assert iterations[1] <= iterations[0] + 6
    assert iterations[1] <= 25


@needs_multigrid
@needs_pardiso
def test_iterations_that_do_not_converge_give_way_to_factors(monkeypatch: pytest.MonkeyPatch) -> None:
    """The automatic choice for large solids, here for a small one that is not definite."""
    monkeypatch.setattr(linear, "LARGE_SOLID", 100)
    body = block(6)
    A = shifted(body.matrix, -0.02)
    choice = Automatic().choose(problem(A, symmetric=True, definite=True, has_modes=True))
    assert "multigrid" in choice.explanation
    assert "should it not converge" in choice.explanation
    s = solver(choice, A, body)
    b = right_hand_side(A)
    assert np.linalg.norm(A @ solve(s, A, b) - b) < 1e-10 * np.linalg.norm(b)
    assert "conjugate gradients" in s.message or "PARDISO" in s.message


@pytest.mark.parametrize("options", [PARDISO, EIGEN, *KRYLOV, *MULTIGRID])
def test_same_bits_again(options: Any) -> None:
    """From one run to the next; after `forget` nothing is left of earlier matrices."""
    body = block(5)
    A, other = body.matrix, shifted(body.matrix, 0.1)
    choice = options.choose(problem(A, symmetric=True, definite=True))
    b = right_hand_side(A)
    first = solve(solver(choice, A, body), A, b)
    np.random.default_rng()  # other numbers are drawn meanwhile
    np.random.random(5)  # noqa: NPY002
    s = solver(choice, A, body)
    assert s.factor(other.data)
    assert s.solve(b, np.zeros(len(b)))
    s.forget()
    assert np.array_equal(solve(s, A, b), first)


@pytest.mark.parametrize("options", [PARDISO, EIGEN, *KRYLOV, *MULTIGRID])
def test_not_finite(options: Any) -> None:
    body = block(3)
    s = solver(options.choose(problem(body.matrix, symmetric=True, definite=True)), body.matrix, body)
    broken = body.matrix.data.copy()
    broken[50] = np.nan
    assert not s.factor(broken)
    assert s.factor(body.matrix.data), s.message
    x = np.zeros(body.matrix.shape[0])
    assert not s.solve(np.full(len(x), np.nan), x) or np.isnan(x).any()


@pytest.mark.parametrize("library", [pytest.param("pardiso", marks=needs_pardiso), "eigen"])
def test_memory_is_estimated_before_it_is_used(library: Any) -> None:
    A = block(6).matrix
    options = Direct(library=library, memory_limit=1e5)
    with pytest.raises(vv.InputError, match=r"about .* GB, and 0.0001 GB are available.*Iterative"):
        solver(options.choose(problem(A, symmetric=True, definite=True)), A).factor(A.data)
    assert _core.available_memory() > 1e8


def test_memory_of_lu_factors_is_estimated() -> None:
    """By the pattern: of a solid in space 23 MB, where L and U take 29 (Eigen's own count, 12 bytes an entry)."""
    A = block(10).matrix
    known = problem(A)
    s = solver(Direct(library="eigen").choose(known), A)
    assert s.factor(A.data)
    assert s.memory == pytest.approx(12 * 2.42e6, rel=0.3)
    with pytest.raises(vv.InputError, match=r"about .* GB, and 0.02 GB are available.*Iterative"):
        solver(Direct(library="eigen", memory_limit=2e7).choose(known), A).factor(A.data)


@pytest.mark.parametrize("library", [pytest.param("pardiso", marks=needs_pardiso), "eigen"])
def test_redundant_constraints_are_regularised(library: Any) -> None:
    """A constraint given twice, with its multipliers' diagonal lowered a little."""
    body = block(4)
    n = body.matrix.shape[0]
    G = sp.csr_array(([1.0, 1.0], ([0, 1], [7, 7])), shape=(2, n))
    A = matrix_of(sp.block_array([[body.matrix, G.T], [G, sp.csr_array(np.zeros((2, 2)))]], format="csr"))
    flags = np.array([0] * n + [1, 1], dtype=np.int32)
    known = problem(A, symmetric=True, n_multipliers=2, regularization=1e-9)
    s = solver(Direct(library=library).choose(known), A, multiplier=flags)
    b = np.random.default_rng(0).standard_normal(n + 2)
    b[n:] = 0
    x = solve(s, A, b)
    assert abs(x[7]) < 1e-6
    assert np.linalg.norm((A @ x - b)[:n]) < 1e-6


class LastResort(linear.LinearOptions):
    """Conjugate gradients that may take one iteration, and factors in the shortest steps."""

    def choose(self, problem: Problem) -> Choice:
        hopeless = Iterative(method="gmres", preconditioner="none", tolerance=1e-14, max_iterations=1)
        factors = Direct().choose(problem).in_order
        for c in factors:
            c.last_resort = True
        return Choice((*hopeless.choose(problem).in_order, *factors), "for a test")


def test_last_resort_serves_after_three_halvings() -> None:
    """The step is cut three times before factors are made, and then goes as with factors alone."""

    def moved(options: Any, step: float) -> tuple[vv.System, Any]:
        mesh = vv.BoxMesh(size=(1, 1, 1), counts=(2, 2, 2))
        rubber = vv.NeoHooke(young=100.0, poisson=0.3)
        solid = vv.Solid(mesh=mesh, material=rubber, density=1.0, angular_velocity=(0, 0, 1))
        system = vv.System([solid], vv.Newton(linear=options))
        return system, next(vv.march(system, until=0.8, step=step))

    system, _ = moved(LastResort(), 0.08)
    assert (system.stepper.rejected, system.time) == (3, pytest.approx(0.01, rel=1e-12))
    exact, _ = moved(Direct(), 0.01)
    np.testing.assert_allclose(system.x, exact.x, atol=1e-12)


def test_torus_at_a_small_step_needs_no_factors() -> None:
    """With the inertia of a small step the blocks of the nodes precondition well enough."""
    body = torus(24, 12, 2, h=0.05)
    s = solver(
        Iterative("cg", "block").choose(problem(body.matrix, symmetric=True, definite=True)),
        body.matrix,
        body,
    )
    solve(s, body.matrix, right_hand_side(body.matrix))
    assert 0 < s.iterations < 60


def test_choice_follows_the_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(linear, "has_multigrid", lambda: True)
    monkeypatch.setattr(linear, "missing_pardiso", lambda: "")
    small = Automatic().choose(Problem(n=500, n_entries=4000))
    assert "sparse LU of Eigen" in small.explanation
    flat = Automatic().choose(Problem(n=200_000, n_entries=3_600_000, symmetric=True, definite=True))
    assert "PARDISO of oneMKL with Cholesky" in flat.explanation
    solid: dict[str, Any] = {"n": 200_000, "n_entries": 15_000_000}
    solid |= {"symmetric": True, "definite": True, "has_modes": True}
    assert "conjugate gradients" in Automatic().choose(Problem(**solid)).explanation
    assert "symmetric indefinite" in Automatic().choose(Problem(**solid, n_multipliers=3)).explanation
    assert (
        "PARDISO of oneMKL with LU"
        in Automatic().choose(Problem(**{**solid, "symmetric": False})).explanation
    )


@pytest.mark.parametrize("nearly", [True, False])
def test_discrete_gradients_are_not_quite_symmetric(monkeypatch: pytest.MonkeyPatch, nearly: bool) -> None:
    """Short steps hardly show it; where multigrid or factors take over, they do not count on symmetry."""
    monkeypatch.setattr(linear, "has_multigrid", lambda: True)
    monkeypatch.setattr(linear, "missing_pardiso", lambda: "")
    solid: dict[str, Any] = {"symmetric": True, "definite": True, "has_modes": True, "has_inertia": True}
    choice = Automatic().choose(Problem(n=20_000, n_entries=1_500_000, nearly=nearly, **solid))
    head, *parts = choice.explanation.split("; should it not converge, ")
    assert ("but for terms of the step's length" in head) == nearly
    assert "conjugate gradients to 0.001, preconditioner diagonal" in head
    assert parts[0].startswith("GMRES" if nearly else "conjugate gradients")
    assert "multigrid" in parts[0]
    assert "Cholesky, or where that fails" in parts[1]
    assert parts[1].endswith("LU")
    assert ("symmetric indefinite" in parts[1]) != nearly


def test_explanation_follows_the_scheme() -> None:
    """Energy-momentum steps and trapezoidal ones of the same system."""
    mesh = vv.BoxMesh(size=(1, 0.2, 0.2), counts=(6, 4, 4))
    block = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.35), density=1000.0)
    system = vv.System([block])
    for scheme in (vv.EnergyMomentum(), vv.GeneralizedAlpha(rho=1.0), vv.EnergyMomentum()):
        prepare(system, scheme)
        said = "but for terms of the step's length" in system.linear_explanation
        assert said == scheme.discrete_gradient


def test_wide_rows_are_left_to_pardiso_early(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(linear, "missing_pardiso", lambda: "")
    quadratic = Automatic().choose(Problem(n=600, n_entries=70_000, symmetric=True, n_multipliers=40))
    assert "PARDISO" in quadratic.explanation
    linear_cells = Automatic().choose(Problem(n=800, n_entries=40_000, symmetric=True, n_multipliers=40))
    assert "PARDISO" not in linear_cells.explanation


@pytest.mark.parametrize(("counts", "words"), [((2, 1, 1), "sparse LU"), ((3, 2, 2), "conjugate gradients")])
def test_small_solids_choose_for_time_steps(counts: tuple[int, int, int], words: str) -> None:
    """A few dozen nodes are factorised; from some hundred unknowns on iterations come first."""
    mesh = vv.BoxMesh(size=(1, 0.2, 0.2), counts=counts, cell="tet10")
    block = vv.Solid(
        mesh=mesh, material=vv.NeoHooke(young=1e6, poisson=0.35), density=1000.0, angular_velocity=(1, 0, 6)
    )
    system = vv.System([block])
    assert words in system.linear_explanation
    result = vv.simulate(system, until=0.02, step=2e-3)
    assert words in system.core.solver
    result.assert_conserved("energy", "angular_z")


def test_what_is_missing_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(linear, "has_multigrid", lambda: False)
    monkeypatch.setattr(linear, "missing_pardiso", lambda: "no such file")
    p = Problem(n=20_000, n_entries=1_000_000)
    assert "PARDISO is missing: no such file" in Direct().choose(p).explanation
    with pytest.raises(vv.InputError, match=r"visviva\[mkl\]"):
        Direct(library="pardiso").choose(p)
    with pytest.raises(vv.InputError, match=r"visviva\[amg\]"):
        Iterative(preconditioner="multigrid").choose(p)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Direct(library="mumps"),
        lambda: Direct(memory_limit=-1.0),
        lambda: Iterative(method="minres"),
        lambda: Iterative(preconditioner="jacobi"),
        lambda: Iterative(tolerance=0.0),
        lambda: Iterative(max_iterations=0),
    ],
)
def test_bad_options(make: Any) -> None:
    with pytest.raises(vv.InputError):
        make()


@pytest.mark.parametrize("options", [PARDISO, EIGEN, Iterative("gmres", "incomplete", tolerance=1e-13)])
def test_a_pendulum_with_any_solver(options: Any) -> None:
    """The whole way through a system's steps: the same motion."""

    def run(choose: bool) -> Array:
        ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0))
        spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0, free_length=1.0)
        system = vv.System([ground, ball, spring, vv.Gravity()])
        if choose:
            row, _, _ = system.core.csr
            system.core.use_linear(list(options.choose(Problem(n=len(row) - 1, n_entries=9)).in_order))
        for _ in vv.march(system, until=0.2, step=0.02):
            pass
        return system.x.copy()

    assert np.abs(run(True) - run(False)).max() < 1e-12


def test_a_step_fails_with_the_solvers_message() -> None:
    ground, ball = vv.Ground(), vv.PointMass(mass=1.0, position=(1, 0, 0), velocity=(0.1, 0.2, 0.3))
    spring = vv.Spring(a=ground.point(), b=ball.point(), stiffness=100.0, free_length=0.5)
    system = vv.System([ground, ball, spring])
    choice = Iterative("gmres", "none", tolerance=1e-13, max_iterations=1).choose(Problem(n=3, n_entries=9))
    system.core.use_linear(list(choice.in_order))
    with pytest.raises(vv.StepFailure, match="no convergence after 1 iterations"):
        list(vv.march(system, until=0.5, step=0.5))


def test_pressures_of_solids_are_none_of_contact() -> None:
    """Solvers for contact do not suit them: they were tried first, in vain."""
    mesh = vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1), cell="tet10")
    solid = vv.Solid(
        mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.4), density=1.0, formulation="mixed"
    )
    system = vv.System([solid, vv.Fixed(solid=solid, nodes="z0")])
    problem = problem_of(system)
    assert (problem.n_pressures, problem.is_contact, problem.symmetric) == (0, False, True)
    assert "GMRES" not in Automatic().choose(problem).explanation


def test_unknowns_of_several_fields_at_a_node_are_solved_together() -> None:
    """Entropies and temperatures of a solid stand where its nodes do; what has no node there stays alone."""
    body = vv.ThermoelasticSolid(
        mesh=vv.BoxMesh(size=(1, 1, 1), counts=(1, 1, 1)),
        material=vv.NeoHooke(young=1.0, poisson=0.3),
        heat=vv.Heat(conductivity=1.0, capacity=1.0),
        density=1.0,
        formulation="enhanced",
    )
    system = vv.System([body])
    found = places(system.model)
    for f in (body.entropy, body.algorithmic):
        assert found[f.start : f.start + 8].tolist() == found[body.motion.start :: 3][:8].tolist()
    assert np.bincount(found).max() == 5
