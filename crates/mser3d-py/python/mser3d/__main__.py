"""``python -m mser3d``: the command."""

import sys

from ._command import main

sys.exit(main())
