"""Tests of the library, its interfaces in C, Fortran and Python, restart, and user routines.

SPDX-License-Identifier: GPL-3.0-or-later
"""
