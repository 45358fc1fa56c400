"""``python -m visviva``: the command line."""

import sys

from visviva.cli import main

sys.exit(main())
