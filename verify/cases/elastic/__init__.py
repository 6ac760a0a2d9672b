"""Elastic bodies, springs, thermal stress, rubber.

SPDX-License-Identifier: GPL-3.0-or-later
"""
