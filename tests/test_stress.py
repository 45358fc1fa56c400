"""Strains and stresses of solids, against closed forms and energies written down again."""

import numpy as np
import pytest

import visviva as vv
from visviva.body.solid_fields import QUANTITIES, components, extrapolation
from visviva.mesh.cells import CELLS

RNG = np.random.default_rng(5)
MU, LAMBDA, BULK = 1.3, 2.1, 7.0
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
FIBRES = ((1.0, 2.0, 0.0), (1.0, -1.0, 1.0))


def det(C):
    return (
        C[..., 0, 0] * (C[..., 1, 1] * C[..., 2, 2] - C[..., 1, 2] * C[..., 2, 1])
        - C[..., 0, 1] * (C[..., 1, 0] * C[..., 2, 2] - C[..., 1, 2] * C[..., 2, 0])
        + C[..., 0, 2] * (C[..., 1, 0] * C[..., 2, 1] - C[..., 1, 1] * C[..., 2, 0])
    )


def invariants(C):
    I1 = np.trace(C, axis1=-2, axis2=-1)
    I2 = 0.5 * (I1**2 - np.trace(C @ C, axis1=-2, axis2=-1))
    return I1, I2, np.sqrt(det(C))


def saint_venant(C):
    E = (C - np.eye(3)) / 2
    return LAMBDA / 2 * np.trace(E, axis1=-2, axis2=-1) ** 2 + MU * np.sum(E * E, axis=(-2, -1))


def neo_hooke(C):
    I1, _, J = invariants(C)
    return MU / 2 * (I1 - 3 - 2 * np.log(J)) + LAMBDA / 2 * (J - 1) ** 2


def mooney(C):
    I1, I2, J = invariants(C)
    return (
        MU * (I1 * J ** (-2 / 3) - 3) + 0.4 * (I2 * J ** (-4 / 3) - 3) + BULK / 4 * (J**2 - 1 - 2 * np.log(J))
    )


def yeoh(C):
    I1, _, J = invariants(C)
    i = I1 * J ** (-2 / 3) - 3
    return MU * i - 0.1 * i**2 + 0.02 * i**3 + BULK / 2 * (J - 1) ** 2


def gent(C):
    I1, _, J = invariants(C)
    return -MU * 20 / 2 * np.log(1 - (I1 * J ** (-2 / 3) - 3) / 20) + BULK / 2 * (J - 1) ** 2


def fibred(C):
    I1, _, J = invariants(C)
    W = MU / 2 * (I1 * J ** (-2 / 3) - 3) + BULK / 4 * (J**2 - 1 - 2 * np.log(J))
    for a in FIBRES:
        a = np.array(a) / np.linalg.norm(a)
        e = 0.1 * (I1 * J ** (-2 / 3) - 3) + 0.7 * (J ** (-2 / 3) * (C @ a @ a) - 1)
        W = W + 0.5 / (2 * 0.8) * (np.exp(0.8 * np.where(e.real > 0, e, 0) ** 2) - 1)
    return W


def user(C):
    full = np.empty((C.shape[1], 3, 3), dtype=C.dtype)
    for k, (i, j) in enumerate(VOIGT):
        full[:, i, j] = full[:, j, i] = C[k]
    return neo_hooke(full)


REFERENCES = {
    "saint_venant": (vv.SaintVenantKirchhoff(lame_lambda=LAMBDA, shear=MU), saint_venant),
    "neo_hooke": (vv.NeoHooke(lame_lambda=LAMBDA, shear=MU, volumetric="quadratic"), neo_hooke),
    "mooney": (vv.MooneyRivlin(c10=MU, c01=0.4, bulk=BULK, isochoric=True, volumetric="simo"), mooney),
    "yeoh": (vv.Yeoh(c1=MU, c2=-0.1, c3=0.02, bulk=BULK, volumetric="quadratic"), yeoh),
    "gent": (vv.Gent(shear=MU, limit=20.0, bulk=BULK, volumetric="quadratic"), gent),
    "fibred": (
        vv.HolzapfelGasserOgden(shear=MU, k1=0.5, k2=0.8, bulk=BULK, fibres=FIBRES, dispersion=0.1),
        fibred,
    ),
    "user": (vv.UserMaterial(function=user), neo_hooke),
}


def some_gradients(n=20, size=0.25):
    return np.eye(3) + size * RNG.uniform(-1, 1, (n, 3, 3))


def complex_stress(W, C):
    """S = 2 dW/dC by the complex step, each of two equal components carrying half of a derivative."""
    S = np.empty(C.shape)
    for i in range(3):
        for j in range(3):
            Z = C.astype(complex)
            Z[:, i, j] += 0.5e-30j
            Z[:, j, i] += 0.5e-30j
            S[:, i, j] = 2 * W(Z).imag / 1e-30
    return S


@pytest.mark.parametrize("name", REFERENCES)
def test_response_of_materials(name):
    material, W = REFERENCES[name]
    F = some_gradients()
    C = np.swapaxes(F, 1, 2) @ F
    energy, stress, moduli = material.respond(components(C))
    S = complex_stress(W, C)
    np.testing.assert_allclose(energy, W(C), rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(stress, components(S), rtol=1e-11, atol=1e-12)
    d = 1e-6  # moduli against differences of the stress along dC
    dC = RNG.uniform(-1, 1, C.shape)
    dC = dC + np.swapaxes(dC, 1, 2)
    slope = (complex_stress(W, C + d * dC) - complex_stress(W, C - d * dC)) / (2 * d)
    doubled = components(dC) * np.array([1, 1, 1, 2, 2, 2]) / 2
    scale = np.abs(slope).max()
    np.testing.assert_allclose(np.einsum("nij,nj->ni", moduli, doubled), components(slope), atol=2e-8 * scale)


def body(cell, material, plane="strain", distorted=0.0, moved=0.0):
    """A mesh of a cell type with inner and outer nodes moved at random."""
    if CELLS[cell].dimension == 3:
        mesh = vv.BoxMesh(size=(2, 1, 1), counts=(2, 2, 1), cell=cell).build()
    else:
        mesh = vv.RectangleMesh(size=(2, 1), counts=(2, 2), cell=cell).build()
    X = mesh.points + distorted * RNG.uniform(-1, 1, mesh.points.shape) + moved
    return vv.Solid(mesh=vv.Mesh(X, mesh.cells), material=material, plane=plane)


SPACE = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6")
PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
TRUSTED = {"hex8": 0.05, "tet4": 0.05, "wedge6": 0.05, "tri3": 0.05, "quad4": 0.05}


@pytest.mark.parametrize("name", REFERENCES)
@pytest.mark.parametrize("cell", [*SPACE, *PLANE])
def test_homogeneous_deformation(cell, name):
    """Every cell type, every material: sigma = F S F^T / J of the same F everywhere, at points and nodes."""
    material, W = REFERENCES[name]
    solid = body(cell, material, distorted=TRUSTED.get(cell, 0.02))
    system = vv.System([solid])
    F = some_gradients(1)[0]
    if solid.dimension == 2:
        F[2], F[:, 2] = (0, 0, 1), (0, 0, 1)
    x = (solid.points @ F.T)[:, : solid.dimension].ravel() + 0.0
    S = complex_stress(W, (F.T @ F)[None])[0]
    J = np.linalg.det(F)
    sigma = F @ S @ F.T / J
    fields = solid.fields(x)
    m, q = fields.energy.shape
    assert (m, q) == (solid.grid.n_cells, len(solid.volumes[0][0]))
    expect = {
        "F": F,
        "second_piola": S,
        "first_piola": F @ S,
        "cauchy": sigma,
        "J": J,
        "energy": W((F.T @ F)[None])[0],
        "pressure": -np.trace(sigma) / 3,
        "von_mises": np.sqrt(
            0.5 * sum((sigma[i, i] - sigma[j, j]) ** 2 for i, j in ((0, 1), (1, 2), (2, 0)))
            + 3 * (sigma[0, 1] ** 2 + sigma[1, 2] ** 2 + sigma[2, 0] ** 2)
        ),
        "stretches": np.linalg.svd(F)[1],
        "principal_stresses": np.sort(np.linalg.eigvalsh(sigma))[::-1],
        "green": (F.T @ F - np.eye(3)) / 2,
    }
    for key, value in expect.items():
        np.testing.assert_allclose(
            getattr(fields, key), np.broadcast_to(value, (m, q, *np.shape(value))), atol=1e-11, err_msg=key
        )
    for key, (width, _) in QUANTITIES.items():
        value = expect[key]
        if width == 6:
            value = components(value)
        rows = np.broadcast_to(np.ravel(value), (solid.grid.n_nodes, width))
        np.testing.assert_allclose(solid.nodal(key, x).reshape(-1, width), rows, atol=1e-10, err_msg=key)
        rows = np.broadcast_to(np.ravel(value), (solid.grid.n_cells, width))
        np.testing.assert_allclose(solid.mean(key, x).reshape(-1, width), rows, atol=1e-10, err_msg=key)
    assert system.n_coordinates == len(x)


@pytest.mark.parametrize("cell", [*SPACE, *PLANE])
def test_small_strains_in_the_plane_and_in_space(cell):
    """Hooke's law with its stress across the plane, sigma_33 = nu (sigma_11 + sigma_22)."""
    nu, E = 0.3, 200.0
    solid = body(cell, vv.LinearElastic(young=E, poisson=nu))
    vv.System([solid])
    H = 1e-3 * RNG.uniform(-1, 1, (3, 3))
    if solid.dimension == 2:
        H[2], H[:, 2] = 0, 0
    e = (H + H.T) / 2
    sigma = E / (1 + nu) * (e + nu / (1 - 2 * nu) * np.trace(e) * np.eye(3))
    x = (solid.points @ (np.eye(3) + H).T)[:, : solid.dimension].ravel()
    fields = solid.fields(x)
    for found in (fields.cauchy, fields.first_piola, fields.second_piola):
        np.testing.assert_allclose(found, np.broadcast_to(sigma, found.shape), atol=1e-12)
    np.testing.assert_allclose(fields.green, np.broadcast_to(e, fields.green.shape), atol=1e-15)
    if solid.dimension == 2:
        s = fields.cauchy
        np.testing.assert_allclose(s[..., 2, 2], nu * (s[..., 0, 0] + s[..., 1, 1]), atol=1e-12)


@pytest.mark.parametrize("cell", PLANE)
def test_hoop_stretch_of_revolutions(cell):
    """Uniform radial stretch: the hoop stretch equals the radial one."""
    material, W = REFERENCES["neo_hooke"]
    solid = body(cell, material, plane="axisymmetric", moved=0.5)
    vv.System([solid])
    F = np.diag([1.2, 0.9, 1.2])
    x = (solid.points @ F)[:, :2].ravel()
    fields = solid.fields(x)
    S = complex_stress(W, (F @ F)[None])[0]
    np.testing.assert_allclose(fields.F, np.broadcast_to(F, fields.F.shape), atol=1e-13)
    np.testing.assert_allclose(fields.second_piola, np.broadcast_to(S, fields.F.shape), atol=1e-11)


@pytest.mark.parametrize("cell", ["tet10", "hex20", "hex27", "tri6", "quad8", "quad9"])
def test_linear_stress_comes_out_exactly(cell):
    """Pure bending of the linear theory, u = (x y, -x^2/2, 0) for nu = 0: sigma_11 = E y, also at the nodes."""
    solid = body(cell, vv.LinearElastic(young=3.0, poisson=0.0))
    vv.System([solid])
    X, Y = solid.points[:, 0], solid.points[:, 1]
    u = 1e-2 * np.column_stack([X * Y, -(X**2) / 2, np.zeros(len(X))])
    x = (solid.points + u)[:, : solid.dimension].ravel()
    expected = np.zeros((len(X), 6))
    expected[:, 0] = 3e-2 * Y
    np.testing.assert_allclose(solid.nodal("cauchy", x), expected, atol=1e-13)


def test_least_squares_of_the_trilinear_brick():
    """Values 1, x, y, z, xy, ..., xyz at Gauss points become those at the corners."""
    a = 1 / np.sqrt(3)
    corners = CELLS["hex8"].nodes
    for powers in np.ndindex(2, 2, 2):
        points = np.array([[x, y, z] for z in (-a, a) for y in (-a, a) for x in (-a, a)])
        at_points = np.prod(points ** np.array(powers), axis=1)
        np.testing.assert_allclose(
            extrapolation("hex8") @ at_points, np.prod(corners ** np.array(powers), axis=1), atol=1e-14
        )


@pytest.mark.parametrize("name", REFERENCES)
@pytest.mark.parametrize("cell", ["hex8", "tet10", "quad8"])
def test_stress_does_the_work_of_the_nodal_forces(cell, name):
    """Forces on nodes by the residual of the system equal -sum P : dF over points, element by element."""
    solid = body(cell, REFERENCES[name][0], distorted=0.02)
    system = vv.System([solid])
    system.x[:] += 0.05 * RNG.uniform(-1, 1, len(system.x))
    system.invalidate()
    forces = solid.nodal_forces(system.x)
    residual = system.residual(vv.Static().step(0.0, 0.0))
    np.testing.assert_allclose(forces[:, : solid.dimension].ravel(), -residual, atol=1e-12)
    d = RNG.uniform(-1, 1, len(system.x))
    dF = solid.fields(d).F - np.diag([0, 0, solid.dimension == 2])  # linear in the nodes
    work = np.einsum("mq,mqij,mqij->", solid.volumes[0], solid.fields(system.x).first_piola, dF)
    assert work == pytest.approx(residual @ d, rel=1e-11)
    half = np.arange(solid.grid.n_cells) % 2 == 0
    parts = solid.nodal_forces(system.x, half) + solid.nodal_forces(system.x, ~half)
    np.testing.assert_allclose(parts, forces, atol=1e-12)


def test_parts_of_a_large_mesh_fit_together(monkeypatch):
    mesh = vv.BoxMesh(size=(3, 2, 1), counts=(7, 5, 3))
    solid = vv.Solid(mesh=mesh, material=REFERENCES["gent"][0])
    system = vv.System([solid])
    x = system.x + 0.02 * RNG.uniform(-1, 1, len(system.x))
    whole = solid.nodal("cauchy", x), solid.mean("cauchy", x)
    monkeypatch.setattr("visviva.body.solid_fields.CHUNK", 8)
    np.testing.assert_allclose(solid.nodal("cauchy", x), whole[0], atol=1e-14)
    np.testing.assert_allclose(solid.mean("cauchy", x), whole[1], atol=1e-14)


def test_mixed_meshes_and_wrong_names():
    points = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0)]
    mesh = vv.Mesh(points, {"quad4": [(0, 1, 2, 3)], "tri3": [(1, 4, 2)]})
    solid = vv.Solid(mesh=mesh, material=vv.NeoHooke(young=1.0, poisson=0.3), name="leaf")
    system = vv.System([solid])
    x = 1.1 * system.x
    assert np.ptp(solid.nodal("J", x)) < 1e-14
    assert solid.mean("J", x) == pytest.approx([1.21, 1.21])
    assert solid.fields(x, "tri3").J.shape == (1, 1)
    with pytest.raises(vv.InputError, match="'leaf' has the cells quad4, tri3; say of which"):
        solid.fields(x)
    with pytest.raises(vv.InputError, match="did you mean 'quad4'"):
        solid.fields(x, "quad")
    with pytest.raises(vv.InputError, match="did you mean 'von_mises'"):
        solid.nodal("von_misses", x)
