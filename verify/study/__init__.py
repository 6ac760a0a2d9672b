"""Studies over many jobs: line searches, increments, random contact.

SPDX-License-Identifier: GPL-3.0-or-later
"""
