"""Hosts of this computer, and others."""

import socket

import pytest

from atlas_drake.addresses import is_private


def _has_ipv6():
    try:
        with socket.socket(socket.AF_INET6) as probe:
            probe.bind(("::1", 0))
    except OSError:
        return False
    return True


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "127.0.0.2"])
def test_loopback_is_for_this_computer_alone(host):
    assert is_private(host)


@pytest.mark.skipif(not _has_ipv6(), reason="this computer has no IPv6")
def test_loopback_of_ipv6_is_for_this_computer_alone():
    assert is_private("::1")


@pytest.mark.parametrize("host", ["*", "0.0.0.0"])
def test_all_addresses_are_for_others_too(host):
    assert not is_private(host)


@pytest.mark.parametrize("host", ["192.0.2.1", "no.such.host.invalid", "a" * 70])
def test_another_computer_is_not_listened_on(host):
    with pytest.raises((OSError, ValueError)):
        is_private(host)
