"""A staggered loop like that with a flow solver: pressure on a face depends on how far it has moved.

A wall with a spring behind it stands in for the flow: the fluid gives the pressure p = k (h - u) on the face, u its mean
displacement. In each window the solid is tried with the last pressure, rolled back, and tried again with a better one
(Aitken's relaxation), until the pressure converges; then it commits. Küttler and Wall, Computational Mechanics 43 (2008) 61.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import amontons

DECK = """\
*NODE, NSET=ALL
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=WALL
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=BOTTOM
1, 2, 3, 4
*SURFACE, NAME=WET
WALL, S2
*MATERIAL, NAME=M
*ELASTIC
1000, 0
*SOLID SECTION, ELSET=WALL, MATERIAL=M
*STEP
*STATIC
0.25, 1
*BOUNDARY
ALL, 1, 2
BOTTOM, 3
*END STEP
"""


def couple(flow_stiffness: float, stroke: float, n_windows: int = 4) -> tuple[list[float], list[int]]:
    """The mean displacement of the wet face after each window, and the number of tries of each."""
    displacements, tries = [], []
    with amontons.Job(text=DECK) as job:
        u = 0.0
        for window in range(1, n_windows + 1):
            height = stroke * window / n_windows
            relaxation, before, n = 0.5, 0.0, 0
            while True:
                job.set("P", "WET", flow_stiffness * (height + u))
                job.try_step(1 / n_windows)
                reached = float(job.get("U", "WET")[:, 2].mean())
                residual = reached - u
                n += 1
                if abs(residual) < 1e-13:
                    break
                if n > 1:
                    relaxation *= -before / (residual - before)
                u, before = u + relaxation * residual, residual
                job.rollback()
            job.commit()
            displacements.append(reached)
            tries.append(n)
    return displacements, tries
