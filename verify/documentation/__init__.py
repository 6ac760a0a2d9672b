"""Tests of the documentation: its decks run, its links lead to pages, its figures name their commands.

SPDX-License-Identifier: GPL-3.0-or-later
"""
