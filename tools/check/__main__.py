"""`python -m gearheat.tools.check`."""

import sys

from . import main

sys.exit(main(sys.argv[1:]))
