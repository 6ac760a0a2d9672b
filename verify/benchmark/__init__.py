"""Run times, beside those of CalculiX.

SPDX-License-Identifier: GPL-3.0-or-later
"""
