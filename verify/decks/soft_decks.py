"""Decks with a soft motion beside a stiff part, on which loose convergence criteria are easily met by a wrong answer.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import numpy as np

from verify.decks.make_decks import block, join
from verify.decks.solids import as_kind

SPRING_SOFT, SPRING_CUBIC = 0.1, 1.0  # the spring's force: SPRING_SOFT u + SPRING_CUBIC u^3


def field_controls(tolerance: float) -> str:
    """*CONTROLS with one tolerance for residual and correction."""
    return f"*CONTROLS, PARAMETERS=FIELD\n{tolerance:g}, {tolerance:g}, , {tolerance:g}, {0.01 * tolerance:g}\n"


def spring_beside_bar(pull: float, force: float, n: int, controls: str = "") -> str:
    """A bar of stiffness 1e8 under a pull, and at its end across it a spring that stiffens, under a small force; half of both after.

    The table of the spring has steps of 0.01.
    """
    table = "".join(f"{SPRING_SOFT * u + SPRING_CUBIC * u**3:.12g}, {u:.12g}\n" for u in np.linspace(-4, 10, 1401))
    steps = "".join(f"*STEP, NLGEOM\n*STATIC, DIRECT\n{1 / n:.10g}, 1.\n{controls}*CLOAD\n2, 1, {part * pull:.10g}\n"
                    f"3, 2, {part * force:.10g}\n*NODE PRINT, NSET=END\nU\n*END STEP\n" for part in (1.0, 0.5))
    return f"""*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
*NSET, NSET=END
3
*ELEMENT, TYPE=T3D2, ELSET=BAR
1, 1, 2
*MATERIAL, NAME=M
*ELASTIC
1e8, 0.
*SOLID SECTION, ELSET=BAR, MATERIAL=M
1.
*ELEMENT, TYPE=SPRINGA, ELSET=SOFT
2, 2, 3
*SPRING, NONLINEAR, ELSET=SOFT

{table}*BOUNDARY
1, 1, 3
2, 2, 3
3, 1
3, 3
{steps}"""


def cantilever_on_a_rope(load: tuple[float, float, float], anchor: tuple[float, float, float], slack: float, n: int = 10,
                         controls: str = "") -> str:
    """A clamped bar of C3D20R along z, 1 by 1 by 8, a corner of its end hung on a rope to the anchor; the corner is loaded in n
    increments and unloaded in n. The deck is of the calculix dialect.
    """
    mesh = as_kind(block([0, 0.5, 1], [0, 0.5, 1], np.linspace(0, 8, 5), "BAR"), "C3D20R")
    (tip,) = (int(k) + 1 for k in np.flatnonzero(np.linalg.norm(mesh.nodes - [0, 0, 8], axis=1) < 1e-9))
    fixed = "\n".join(f"{k + 1}," for k in mesh.where(2, 0.0))
    length = float(np.linalg.norm(np.array([0, 0, 8]) - anchor)) + slack
    steps = "".join(f"*STEP, NLGEOM\n*STATIC, DIRECT\n{1 / n:.10g}, 1.\n{controls}*CLOAD\n"
                    + "".join(f"TIP, {k}, {part * p:.10g}\n" for k, p in enumerate(load, start=1) if p)
                    + "*NODE PRINT, NSET=TIP\nU\n*END STEP\n" for part in (1.0, 0.0))
    return f"""** dialect: calculix
{mesh.cards()}*NODE
9001, {', '.join(f'{x:.10g}' for x in anchor)}
9002, {length:.12g}, 0., 0.
*NSET, NSET=FIXED
{fixed}
*NSET, NSET=TIP
{tip}
*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL
*MPC
DIST, {tip}, {tip}, {tip}, 9001, 9001, 9001, 9002
*BOUNDARY
FIXED, 1, 3
9001, 1, 3
9002, 1, 3
{steps}"""


def strip_bent_both_ways(kind: str, n_cells: int = 8, controls: str = "") -> str:
    """A clamped strip, 10 by 2 by 0.05, whose end is bent by a force across it, and by one twenty times as large along its width at a
    corner: it twists, and the force in its plane bends it across as well. The deck is of the calculix dialect.
    """
    mesh = as_kind(block(np.linspace(0, 10, n_cells + 1), [0, 1, 2], [0, 0.05], "STRIP"), kind)
    x = mesh.nodes
    chosen = {"ROOT": np.isclose(x[:, 0], 0), "TIP": np.isclose(x[:, 0], 10), "CORNER": np.isclose(x[:, 0], 10) & np.isclose(x[:, 1], 0)}
    sets = "".join(f"*NSET, NSET={name}\n" + "".join(f"{k + 1},\n" for k in np.flatnonzero(where)) for name, where in chosen.items())
    return f"""** dialect: calculix
{mesh.cards()}{sets}*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL
*BOUNDARY
ROOT, 1, 3
*STEP, NLGEOM
*STATIC
{controls}*CLOAD
TIP, 3, {0.005448 / chosen["TIP"].sum():.10g}
CORNER, 2, {0.10896 / chosen["CORNER"].sum():.10g}
*NODE PRINT, NSET=TIP
U
*END STEP
"""


def tied_tee(controls: str = "") -> str:
    """A clamped plate of C3D8I, 10 by 2 by 0.5, with an upright one and a gusset tied to it and to each other, bent and twisted in one
    increment: bending and membrane motion are corrected in turn. The corner nodes of the gusset are slaves of two ties. The deck is
    of the calculix dialect.
    """
    cells = {"BASE": (40, 4, 2), "UPRIGHT": (2, 4, 20), "GUSSET": (22, 3, 17)}
    lows = {"BASE": (0.0, 0.0, -0.5), "UPRIGHT": (4.75, 0.0, 0.0), "GUSSET": (5.25, 0.5, 0.0)}
    highs = {"BASE": (10.0, 2.0, 0.0), "UPRIGHT": (5.25, 2.0, 5.0), "GUSSET": (9.0, 1.5, 3.0)}
    blocks = join([block(*(np.linspace(a, b, n + 1) for a, b, n in zip(lows[k], highs[k], cells[k], strict=True)), k) for k in cells])
    mesh = as_kind(blocks, "C3D8I")
    x = blocks.nodes
    sets = {"FIXED": np.isclose(x[:, 0], 0.0), "TIP": np.isclose(x[:, 2], 5.0),
            "SIDE": np.isclose(x[:, 0], 9.0) & np.isclose(x[:, 2], 3.0)}
    cards = "".join(f"*NSET, NSET={name}\n" + "".join(f"{k + 1},\n" for k in np.flatnonzero(chosen)) for name, chosen in sets.items())
    sides = (("BASE_TOP", 2, 0.0, 2), ("UPRIGHT_BOTTOM", 2, 0.0, 1), ("GUSSET_BOTTOM", 2, 0.0, 1), ("UPRIGHT_PLANE", 0, 5.25, 4),
             ("GUSSET_PLANE", 0, 5.25, 6))
    for name, axis, value, face in sides:
        chosen = [e for e in blocks.element_sets[name.split("_")[0]] if np.isclose(x[blocks.elements[e], axis], value).sum() == 4]
        cards += f"*SURFACE, NAME={name}\n" + "".join(f"{e + 1}, S{face}\n" for e in chosen)
    for slave, master in (("UPRIGHT_BOTTOM", "BASE_TOP"), ("GUSSET_BOTTOM", "BASE_TOP"), ("GUSSET_PLANE", "UPRIGHT_PLANE")):
        cards += f"*TIE, NAME={slave}, POSITION TOLERANCE=.01\n{slave}, {master}\n"
    return f"""** dialect: calculix
{mesh.cards()}{cards}*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL
*BOUNDARY
FIXED, 1, 3
*STEP, NLGEOM
*STATIC
{controls}*CLOAD
TIP, 1, {-100 / sets["TIP"].sum():.10g}
SIDE, 3, -20.
*NODE PRINT, NSET=TIP
U
*END STEP
"""
