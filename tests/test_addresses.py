"""Hosts of this computer, and others."""

import pytest

from atlas_drake.addresses import is_private


@pytest.mark.parametrize(
    ("host", "private"),
    [("localhost", True), ("127.0.0.2", True), ("*", False), ("0.0.0.0", False)],
)
def test_loopback_alone_is_private(host, private):
    assert is_private(host) == private


@pytest.mark.parametrize("host", ["192.0.2.1", "no.such.host.invalid", "a" * 70])
def test_another_computer_is_not_listened_on(host):
    with pytest.raises((OSError, ValueError)):
        is_private(host)
