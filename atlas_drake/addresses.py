"""Addresses of this computer that a page can be served on."""

from __future__ import annotations

import ipaddress
import socket

LOCALHOST, ANYWHERE = "localhost", "*"
"""Hosts for this computer alone, and hosts for all its addresses."""


def is_private(host: str) -> bool:
    """Returns True if this computer alone can reach a host.

    Raises OSError or ValueError for a host that is not, or not this computer.
    """
    if host == ANYWHERE:
        return False
    found = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)
    family, kind, _, _, address = found[0]
    with socket.socket(family, kind) as probe:
        probe.bind(address)
    # The part after % is the interface of an IPv6 address.
    return ipaddress.ip_address(str(address[0]).partition("%")[0]).is_loopback
