"""Internal forces of C3D8 with mean dilatation, from displacements alone; all elements at once.

Finite strain: Fbar = (Jbar/J)^(1/3) F with Jbar = v/V the mean of the element (Hughes 1980; de Souza Neto et al. 1996),
Kirchhoff stress tau = lambda tr(e) 1 + 2 G e, e = 1/2 ln(Fbar Fbar') (Hencky). The forces are the gradient of the
energy W = sum w J0 psi(Fbar):

    f_a = sum w J0 [ tau g_a + p (gbar_a - g_a) ],   p = tr(tau)/3,   gbar_a = (1/v) sum w J0 J g_a

with g_a the spatial gradients of the shape functions. Small displacements: the same with F = 1 there (B-bar).

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
#: The eight Gauss points, xi fastest; all weights are one.
POINTS = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) / np.sqrt(3.0)


@dataclass
class ElementState:
    """What the elements give at their integration points."""

    forces: Floats  #: (n_elements, 8, 3) nodal forces [force]
    cauchy: Floats  #: (n_elements, 8, 3, 3) Cauchy stress [stress]
    energy: Floats  #: (n_elements) strain energy [energy]
    jacobian: Floats  #: (n_elements, 8) J = det F at the points [-]


def shape_slopes() -> Floats:
    """(8 points, 8 nodes, 3) derivatives of the trilinear shape functions at the Gauss points."""
    terms = 1.0 + POINTS[:, None, :] * CORNERS[None, :, :]
    slopes = np.empty((8, 8, 3))
    for d in range(3):
        others = [k for k in range(3) if k != d]
        slopes[:, :, d] = CORNERS[None, :, d] * terms[:, :, others].prod(axis=2) / 8.0
    return slopes


def reference_gradients(corners: Floats) -> tuple[Floats, Floats]:
    """(n, 8, 8, 3) gradients dN/dX and (n, 8) volumes w J0 of the points, from reference corners (n, 8, 3)."""
    slopes = shape_slopes()
    jacobian = np.einsum("eai,gak->egik", corners, slopes)
    gradients = np.einsum("gak,egki->egai", slopes, np.linalg.inv(jacobian))
    return gradients, np.linalg.det(jacobian)


def element_state(corners: Floats, displacements: Floats, elastic: Floats, is_nlgeom: bool) -> ElementState:
    """Forces, stresses and energy of all elements.

    corners, displacements: (n, 8, 3); elastic: (n, 2) E and nu.
    """
    gradients, volume = reference_gradients(corners)
    young, nu = elastic[:, 0, None], elastic[:, 1, None]
    lame, shear = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    if is_nlgeom:
        return _finite(corners + displacements, gradients, volume, lame, shear)
    return _small(displacements, gradients, volume, lame, shear)


def _hooke(strain: Floats, lame: Floats, shear: Floats) -> tuple[Floats, Floats]:
    """Stress linear in a strain (n, 8, 3, 3), and energy density."""
    trace = np.trace(strain, axis1=2, axis2=3)
    stress = 2 * shear[..., None, None] * strain + (lame * trace)[..., None, None] * np.eye(3)
    return stress, 0.5 * np.einsum("egij,egij->eg", stress, strain)


def _forces(stress: Floats, gradients: Floats, mean: Floats, volume: Floats) -> Floats:
    """sum w J0 [ tau g_a + p (gbar_a - g_a) ]."""
    pressure = np.trace(stress, axis1=2, axis2=3) / 3
    forces = np.einsum("eg,egij,egaj->eai", volume, stress, gradients)
    return forces + np.einsum("eg,egai->eai", volume * pressure, mean[:, None] - gradients)


def _finite(corners: Floats, gradients: Floats, volume: Floats, lame: Floats, shear: Floats) -> ElementState:
    deformation = np.einsum("eai,egaj->egij", corners, gradients)
    jacobian = np.linalg.det(deformation)
    current = volume * jacobian
    mean_jacobian = (current.sum(axis=1) / volume.sum(axis=1))[:, None]
    bar = np.cbrt(mean_jacobian / jacobian)[..., None, None] * deformation
    squares, axes = np.linalg.eigh(bar @ bar.transpose(0, 1, 3, 2))
    strain = np.einsum("egik,egk,egjk->egij", axes, 0.5 * np.log(squares), axes)
    tau, density = _hooke(strain, lame, shear)
    spatial = np.einsum("egaj,egji->egai", gradients, np.linalg.inv(deformation))
    mean = np.einsum("eg,egai->eai", current, spatial) / current.sum(axis=1)[:, None, None]
    forces = _forces(tau, spatial, mean, volume)
    return ElementState(forces, tau / mean_jacobian[..., None, None], (volume * density).sum(axis=1), jacobian)


def _small(displacements: Floats, gradients: Floats, volume: Floats, lame: Floats, shear: Floats) -> ElementState:
    slope = np.einsum("eai,egaj->egij", displacements, gradients)
    strain = 0.5 * (slope + slope.transpose(0, 1, 3, 2))
    trace = np.trace(strain, axis1=2, axis2=3)
    mean_trace = ((volume * trace).sum(axis=1) / volume.sum(axis=1))[:, None]
    strain = strain + ((mean_trace - trace) / 3)[..., None, None] * np.eye(3)
    stress, density = _hooke(strain, lame, shear)
    mean = np.einsum("eg,egai->eai", volume, gradients) / volume.sum(axis=1)[:, None, None]
    forces = _forces(stress, gradients, mean, volume)
    return ElementState(forces, stress, (volume * density).sum(axis=1), 1.0 + trace)


def nodal_forces(state: ElementState, elements: Ints, n_nodes: int) -> Floats:
    """(n_nodes, 3) internal forces: sums over the elements."""
    total = np.zeros((n_nodes, 3))
    np.add.at(total, elements.ravel(), state.forces.reshape(-1, 3))
    return total
