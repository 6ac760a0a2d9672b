"""Unit test programs.

SPDX-License-Identifier: GPL-3.0-or-later
"""
