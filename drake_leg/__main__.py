"""``python -m drake_leg``."""

import sys

from drake_leg.cli import main

if __name__ == "__main__":
    sys.exit(main())
