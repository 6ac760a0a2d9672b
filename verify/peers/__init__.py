"""Comparison with CalculiX, and meshes of other programs.

SPDX-License-Identifier: GPL-3.0-or-later
"""
