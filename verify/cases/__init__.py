"""Verification cases by subject, each against theory; some write a page of doc/verification.

SPDX-License-Identifier: GPL-3.0-or-later
"""
