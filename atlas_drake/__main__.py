"""Makes ``python -m atlas_drake`` the same as the command ``atlas-drake``.

Nothing else lives here.
"""

import sys

from atlas_drake.app.main import main

if __name__ == "__main__":
    sys.exit(main())
