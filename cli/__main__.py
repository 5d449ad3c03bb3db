"""`python -m expanded_panoramas.cli VERB …`, where the command itself is not on the path."""

import sys

from . import main

sys.exit(main())
