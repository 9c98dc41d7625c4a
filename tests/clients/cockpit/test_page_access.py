"""Who may open the page, and who may steer."""

import pytest

from atlas_drake.clients.cockpit.page.access import BURST, PER_SECOND, Access, Throttle

HOST = "localhost:8080"
CROSS_SITE = {"Host": HOST, "Sec-Fetch-Site": "cross-site"}
LINK = {"Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "document"}


@pytest.mark.parametrize(
    ("headers", "admitted"),
    [
        ({"Host": HOST}, True),
        ({"Host": "127.0.0.1:8080"}, True),
        ({"Host": "[::1]:8080"}, True),
        ({"Host": "192.168.1.7:80"}, True),
        ({"Host": "localhost:9000"}, True),  # A tunnel.
        ({"Host": "localhost"}, True),
        ({"Host": "[::1]"}, True),
        ({"Host": "evil.example:8080"}, False),
        ({"Host": "evil.example"}, False),
        ({"Host": "localhost.evil.example:8080"}, False),
        ({"Host": "localhost:8080; script-src *"}, False),
        ({"Host": ""}, False),
        ({}, False),
        ({"Host": HOST, "Origin": f"http://{HOST}"}, True),
        ({"Host": "localhost:9000", "Origin": "http://localhost:9000"}, True),
        ({"Host": HOST, "Origin": "http://localhost:9000"}, False),
        ({"Host": HOST, "Origin": "http://localhost"}, False),
        ({"Host": HOST, "Origin": "http://evil.example"}, False),
        ({"Host": HOST, "Origin": "null"}, False),
        ({"Host": HOST, "Sec-Fetch-Site": "none"}, True),
        ({"Host": HOST, "Sec-Fetch-Site": "same-origin"}, True),
        ({"Host": HOST, "Sec-Fetch-Site": "same-site"}, False),
        (CROSS_SITE, False),
        ({**CROSS_SITE, "Sec-Fetch-Mode": "no-cors"}, False),
        ({**CROSS_SITE, **LINK}, True),
        ({**CROSS_SITE, **LINK, "Origin": "http://evil.example"}, False),
        ({**CROSS_SITE, **LINK, "Sec-Fetch-Dest": "iframe"}, False),
    ],
)
def test_only_the_page_itself_is_served(headers, admitted):
    assert Access("localhost", None).admits(headers) is admitted


@pytest.mark.parametrize(
    ("headers", "admitted"),
    [
        ({"Host": HOST, "Origin": f"http://{HOST}"}, True),
        ({"Host": HOST, "Origin": f"http://{HOST}", "User-Agent": "Mozilla"}, True),
        ({"Host": HOST, "Origin": "http://localhost:8081"}, False),
        ({"Host": HOST, "User-Agent": "Mozilla/5.0"}, False),
        ({"Host": HOST}, True),
    ],
)
def test_a_browser_says_where_its_websocket_comes_from(headers, admitted):
    assert Access("localhost", None).admits(headers, websocket=True) is admitted


def test_a_page_for_other_computers_needs_its_token_to_steer():
    open_to_all = Access("0.0.0.0", "secret")
    assert open_to_all.allows("secret")
    assert not open_to_all.allows("")
    assert not open_to_all.allows("sécret")
    assert not open_to_all.allows("\udc80")
    assert open_to_all.url(8080) == "http://localhost:8080/?token=secret"
    assert open_to_all.admits({"Host": "robot.lab:8080"})
    assert open_to_all.admits({"Host": "robot.lab"})
    assert Access("localhost", None).allows("")
    assert Access("::1", None).url(8080) == "http://[::1]:8080/"


def test_a_flood_is_more_than_a_hand_can():
    now = [0.0]
    throttle = Throttle(lambda: now[0])
    assert all(throttle.allows_one_more() for _ in range(BURST))
    assert not throttle.allows_one_more()
    now[0] += 1.0
    assert sum(throttle.allows_one_more() for _ in range(BURST)) == PER_SECOND - 1
