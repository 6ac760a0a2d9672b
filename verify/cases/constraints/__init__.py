"""Multipoint constraints, couplings, ties, rigid bodies, cyclic symmetry.

SPDX-License-Identifier: GPL-3.0-or-later
"""
