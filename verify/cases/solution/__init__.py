"""Model check, increments, stabilization, failures.

SPDX-License-Identifier: GPL-3.0-or-later
"""
