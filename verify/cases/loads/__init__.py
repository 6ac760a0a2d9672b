"""Loads, and what later steps change of loads, materials and the model.

SPDX-License-Identifier: GPL-3.0-or-later
"""
