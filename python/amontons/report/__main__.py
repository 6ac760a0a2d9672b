"""python -m amontons.report job.vtkhdf

SPDX-License-Identifier: GPL-3.0-or-later
"""

from amontons.report import main

raise SystemExit(main())
