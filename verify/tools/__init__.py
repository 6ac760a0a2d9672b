"""Programs of the repository: lint, white space, pictures, pages of the documentation; with their tests.

SPDX-License-Identifier: GPL-3.0-or-later
"""
