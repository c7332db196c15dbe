# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The page's server: for this machine's own page only, and strict about what it is asked."""

import http.client
import json
import re
import socket
import threading
import time
from contextlib import suppress
from importlib import resources

import pytest

from lane_dp_ros.review.handler import STATIC


def asked(served, method: str, path: str, body: str | None = None, **headers: str):
    """Return status, headers and body of the answer to a request."""
    connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=10)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request(method, path, body, {"Host": f"127.0.0.1:{served.port}", **named})
    answer = connection.getresponse()
    return answer.status, answer.headers, answer.read()


def posted(served, path: str, value: object, **headers: str):
    status, _, body = asked(
        served, "POST", path, json.dumps(value), Content_Type="application/json", **headers
    )
    return status, json.loads(body)


def test_every_file_of_the_page_is_served_and_allows_nothing_from_outside(served) -> None:
    there = {path.name for path in (resources.files("lane_dp_ros.review") / "static").iterdir()}
    assert there == {name for name, _ in STATIC.values()}
    for path, (name, kind) in STATIC.items():
        status, headers, body = asked(served, "GET", path)
        assert (status, headers["Content-Type"]) == (200, kind)
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert "unsafe" not in headers["Content-Security-Policy"]
        outside = set(re.findall(rb"""["'(]((?:https?:)?//[^"')]+)""", body)) - {
            b"http://www.w3.org/2000/svg"
        }
        assert outside == set(), name


@pytest.mark.parametrize("host", ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1"])
def test_a_foreign_name_that_leads_here_is_refused(served, host) -> None:
    for method, path in (("GET", "/"), ("GET", "/pictures/0"), ("POST", "/api/undo")):
        status, _, body = asked(served, method, path, Host=host.format(port=served.port))
        assert status == 403
        assert b"only" in body


def test_another_sites_page_may_not_ask(served) -> None:
    verdict = {"left": "correct"}
    for origin in ("http://evil.example", "null", "http://127.0.0.1:1"):
        assert posted(served, "/api/frames/0/verdicts", verdict, Origin=origin)[0] == 403
    own = f"http://127.0.0.1:{served.port}"
    status, answer = posted(served, "/api/frames/0/verdicts", verdict, Origin=own)
    assert (status, answer["verdicts"]) == (200, {"left": "correct", "right": None})


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", ""])
def test_what_a_form_can_send_is_refused(served, kind) -> None:
    status, _, _ = asked(served, "POST", "/api/frames/0/verdicts", '{"left": "correct"}', Content_Type=kind)
    assert status == 415


@pytest.mark.parametrize(
    "path",
    [
        "/x",
        "/../setup.py",
        "/review.js/..",
        "/api/frames/5",
        "/api/frames/-1",
        "/pictures/99",
        "/api/frames/x",
    ],
)
def test_what_is_not_there(served, path) -> None:
    assert asked(served, "GET", path)[0] == 404


@pytest.mark.parametrize(
    ("path", "value", "status", "reason"),
    [
        ("/api/frames/0/verdicts", {}, 400, "expected an object of left, right or both"),
        ("/api/frames/0/verdicts", {"left": "good"}, 400, "expected one of correct, incorrect, missed, none"),
        ("/api/frames/4/verdicts", {"left": "correct"}, 400, "no line was detected left"),
        ("/api/frames/9/verdicts", {"left": "correct"}, 404, "frame 9 is not there: 0 to 4 are"),
        ("/api/frames/0/lines", [{}], 400, "is no line"),
        ("/api/frames/0/colour", {}, 404, "is not here"),
        ("/api/export/yolo", None, 400, "format is 'yolo', expected one of coco, cvat"),
        ("/api/import", {}, 400, "expected the text of a file"),
        ("/api/import", "{}", 400, "images is None"),
    ],
)
def test_what_cannot_be_taken_is_refused_with_a_reason(served, path, value, status, reason) -> None:
    found, answer = posted(served, path, value)
    assert found == status
    assert reason in answer["error"]


def test_broken_json_and_too_much_of_it(served) -> None:
    headers = {"Content_Type": "application/json"}
    assert asked(served, "POST", "/api/undo", "{", **headers)[0] == 400
    assert asked(served, "POST", "/api/undo", "[" * 100_000, **headers)[0] == 400
    assert asked(served, "POST", "/api/undo", "9" * 20_000_001, **headers)[0] == 413
    assert asked(served, "POST", "/api/undo", "", Content_Length="-1", **headers)[0] == 400
    assert posted(served, "/api/undo", None) == (200, {"index": None})


def raw_request(served, head: str, body: str, method: str = "POST") -> bytes:
    first = f"{method} /api/undo HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\n"
    return f"{first}{head}\r\n\r\n{body}".encode()


SMUGGLED = '{"left": "missed", "right": "missed"}'
# With a body that is itself a request, whose length {0} is told, not told, or told twice.
OUTER = {
    "another site": "Origin: http://evil.example\r\nContent-Length: {0}",
    "a form": "Content-Type: text/plain\r\nContent-Length: {0}",
    "no length": "Origin: http://evil.example",
    "chunks": "Transfer-Encoding: chunked\r\nContent-Type: application/json",
    "chunks and a length": "Transfer-Encoding: chunked\r\nContent-Length: 0",
    "two lengths": "Content-Length: 0\r\nContent-Length: {0}\r\nContent-Type: application/json",
    "a sign": "Content-Length: +{0}\r\nContent-Type: application/json",
    "many digits": "Content-Length: " + "9" * 5000 + "\r\nContent-Type: application/json",
    "no JSON": "Content-Length: {0}\r\nContent-Type: application/json",
}


@pytest.mark.parametrize("method", ["GET", "POST", "PUT", "OPTIONS"])
@pytest.mark.parametrize("outer", OUTER.values(), ids=OUTER)
def test_no_body_is_read_as_a_request(served, outer, method) -> None:
    inner = raw_request(
        served, f"Content-Type: application/json\r\nContent-Length: {len(SMUGGLED)}", SMUGGLED
    ).replace(b"/api/undo", b"/api/frames/1/verdicts")
    request = raw_request(served, outer.format(len(inner)), inner.decode(), method)
    if method == "GET":
        request = request.replace(b"GET /api/undo", b"GET /api/elsewhere")
    with socket.create_connection(("127.0.0.1", served.port), timeout=10) as page:
        page.sendall(request)
        answers = b""
        with suppress(ConnectionError):  # closed, with what was not read
            while part := page.recv(65536):
                answers += part
    assert answers.startswith((b"HTTP/1.1 4", b"HTTP/1.1 501"))
    assert answers.count(b"HTTP/1.1") == 1
    assert json.loads(asked(served, "GET", "/api/drive")[2])["table"]["total"] == 0


def test_a_connection_serves_request_after_request(served) -> None:
    connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=10)
    for _ in range(2):
        connection.request("POST", "/api/undo", "null", {"Content-Type": "application/json"})
        kept = connection.sock
        assert json.loads(connection.getresponse().read()) == {"index": None}
        assert connection.sock is kept is not None


def test_numbers_beyond_all_floats_are_refused(served) -> None:
    line = {"id": "1", "role": "other", "kind": "solid", "sure": True, "uv": [[10**400, 1], [2, 3]]}
    status, answer = posted(served, "/api/frames/0/lines", [line])
    assert (status, len(answer["error"]) < 200) == (400, True)
    assert "expected two finite numbers [u, v]" in answer["error"]


def test_a_change_that_cannot_be_saved_is_told(served, drive_bag) -> None:
    # A folder in the place of the file: nothing can be moved there, not even by root.
    file = drive_bag.with_name("drive.mcap.review.json")
    (file / "in the way").mkdir(parents=True)
    status, answer = posted(served, "/api/frames/0/verdicts", {"left": "correct"})
    assert status == 500
    assert "directory" in answer["error"].lower()
    assert json.loads(asked(served, "GET", "/api/drive")[2])["table"]["total"] == 0


def test_a_stamp_is_written_as_text(served) -> None:
    # 1317000000.1 s in ns is more than a number of JavaScript can hold.
    assert json.loads(asked(served, "GET", "/api/frames/1")[2])["stamp"] == "1317000000.100"


def test_the_end_waits_for_the_last_answer_and_takes_no_more(served) -> None:
    with served.server.site.requests.one_more():  # such as a change that is being saved
        ended = threading.Thread(target=served.end)
        ended.start()
        ended.join(0.5)
        assert ended.is_alive()
    ended.join(5)
    assert not ended.is_alive()
    with pytest.raises(Exception, match="this review was ended"):
        with served.server.site.requests.one_more():
            pass


def test_a_process_ends_well_amid_requests(start_review, drive_bag) -> None:
    review = start_review(drive_bag)
    stop = threading.Event()

    def ask() -> None:
        with suppress(OSError, http.client.HTTPException):
            while not stop.is_set():
                asked(review, "GET", "/pictures/0")

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    time.sleep(0.3)
    review.end()
    stop.set()
    for thread in threads:
        thread.join()
