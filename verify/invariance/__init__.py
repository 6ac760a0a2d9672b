"""The same model in other units, turned, renumbered or reordered has the same solution.

SPDX-License-Identifier: GPL-3.0-or-later
"""
