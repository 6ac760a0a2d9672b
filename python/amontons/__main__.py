"""`python -m amontons` is the program.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from amontons.command import main

main()
