"""Makes ``python -m atlas_drake`` the same as the command ``atlas-drake``."""

import sys

from atlas_drake.clients.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
