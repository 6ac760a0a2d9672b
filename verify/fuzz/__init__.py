"""Decks, checkpoints and library calls with random errors.

SPDX-License-Identifier: GPL-3.0-or-later
"""
