"""What the checks compute for themselves: a deck reader, an element, the geometry of contact. Nothing from the solver.

SPDX-License-Identifier: GPL-3.0-or-later
"""
