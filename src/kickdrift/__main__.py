"""``python -m kickdrift`` is the command line."""

import sys

from kickdrift.cli import main

sys.exit(main())
