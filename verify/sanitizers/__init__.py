"""Jobs under the sanitizers of the compiler.

SPDX-License-Identifier: GPL-3.0-or-later
"""
