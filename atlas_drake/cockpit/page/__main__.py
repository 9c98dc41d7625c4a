"""Serves the page until the line to the simulation is closed."""

from __future__ import annotations

import sys

from atlas_drake.cockpit.page.server import serve

if __name__ == "__main__":
    descriptor, host, port = sys.argv[1:]
    serve(int(descriptor), host, int(port))
