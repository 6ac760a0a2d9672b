"""Tests, verification, studies and benchmarks of Amontons, as one package: `python -m verify.study.random_contact` from the top of the repository.

SPDX-License-Identifier: GPL-3.0-or-later
"""
