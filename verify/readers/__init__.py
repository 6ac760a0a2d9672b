"""Readers of result files: .dat and .frd as CalculiX writes them, .sta and .cvg.

SPDX-License-Identifier: GPL-3.0-or-later
"""
