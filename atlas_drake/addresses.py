"""Addresses of this computer that a page can be served on."""

from __future__ import annotations

import ipaddress
import socket

LOCALHOST, ANYWHERE = "localhost", "*"
"""Hosts for this computer alone, and hosts for all its addresses."""


def address_of(host: str) -> str:
    """Returns the address that a host of this computer stands for.

    Raises:
        OSError: If there is no such host, or it is another computer.
        ValueError: If no host can have that name.
    """
    family, kind, _, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[
        0
    ]
    with socket.socket(family, kind) as probe:
        probe.bind(address)
        return str(address[0])


def is_private(host: str) -> bool:
    """Returns True if this computer alone can reach a host.

    Raises:
        OSError: If there is no such host, or it is another computer.
        ValueError: If no host can have that name.
    """
    if host == ANYWHERE:
        return False
    # The part after % is the interface of an IPv6 address.
    return ipaddress.ip_address(address_of(host).partition("%")[0]).is_loopback
