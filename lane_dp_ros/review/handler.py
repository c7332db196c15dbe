# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the page's server answers: to its own page alone, and nothing from outside."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from importlib import resources
from typing import Any

from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.review.open_requests import OpenRequests, RefusedError
from lane_dp_ros.review.review import Review

ADDRESS = "127.0.0.1"
LARGEST_REQUEST = 20_000_000  # bytes; the lines of a thousand frames in COCO's format
LENGTH = re.compile("[0-9]{1,12}")
LONGEST_ERROR = 1000  # characters
DROPPED = 2 * LARGEST_REQUEST  # bytes of a larger request that are read for nothing, the rest is cut off
STATIC = {
    "/": ("index.html", "text/html; charset=utf-8"),
    "/review.css": ("review.css", "text/css; charset=utf-8"),
    "/review.js": ("review.js", "text/javascript; charset=utf-8"),
    "/api.js": ("api.js", "text/javascript; charset=utf-8"),
    "/files.js": ("files.js", "text/javascript; charset=utf-8"),
    "/editor.js": ("editor.js", "text/javascript; charset=utf-8"),
    "/picture.js": ("picture.js", "text/javascript; charset=utf-8"),
    "/icon.svg": ("icon.svg", "image/svg+xml"),
}
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
JSON = "application/json"
GONE = (ConnectionError, TimeoutError)  # what a page that was closed leaves behind


@dataclass
class Site:
    """What the page stands on: its port, the review once there is one, the requests at work."""

    port: int = 0
    review: Review | None = None
    requests: OpenRequests = field(default_factory=OpenRequests)


class Handler(BaseHTTPRequestHandler):
    """Answers one connection's requests."""

    protocol_version = "HTTP/1.1"
    timeout = 60  # s; a browser opens connections that it never uses

    def __init__(self, site: Site, *arguments: Any) -> None:
        self.site = site
        super().__init__(*arguments)  # answers, too

    def do_GET(self) -> None:
        """Answer with a file of the page, a picture, or JSON."""
        self._answer(self._get)

    def do_POST(self) -> None:
        """Take a change in, or export."""
        self._answer(self._post)

    def log_message(self, *_: object) -> None:
        """Keep quiet: the terminal shows where the page is, not who asked what."""

    def _answer(self, respond: Callable[[Review], tuple[bytes, str]]) -> None:
        try:
            self._read_body()  # left on the connection, it would be taken for the next request
            with self.site.requests.one_more():
                self._check_origin()
                content, kind = respond(self._review())
                self._send(HTTPStatus.OK, content, kind)
        except RefusedError as error:
            self._send_error(error.status, error)
        except LookupError as error:
            self._send_error(HTTPStatus.NOT_FOUND, error)
        except (ValueError, CommandError) as error:
            self._send_error(HTTPStatus.BAD_REQUEST, error)
        except GONE:
            raise
        except OSError as error:
            self._send_error(HTTPStatus.INTERNAL_SERVER_ERROR, error)

    def _review(self) -> Review:
        if self.site.review is None:
            raise RefusedError(HTTPStatus.SERVICE_UNAVAILABLE, "the review has not begun")
        return self.site.review

    def _check_origin(self) -> None:
        """Refuse what does not come from our own page: another site's name that leads here, another site."""
        hosts = [f"{name}:{self.site.port}" for name in (ADDRESS, "localhost")]
        if self.headers.get("Host") not in hosts:
            raise RefusedError(HTTPStatus.FORBIDDEN, f"this is http://{hosts[0]}/ only")
        if self.headers.get("Origin", f"http://{hosts[0]}") not in [f"http://{host}" for host in hosts]:
            raise RefusedError(HTTPStatus.FORBIDDEN, "another site's page may not ask this")

    def _get(self, review: Review) -> tuple[bytes, str]:
        path = self.path.partition("?")[0]
        if path in STATIC:
            name, kind = STATIC[path]
            return (resources.files(__package__) / "static" / name).read_bytes(), kind
        if path == "/api/drive":
            return _json(review.overview())
        match path.split("/"):
            case ["", "api", "frames", number] if number.isdecimal():
                return _json(review.frame(int(number)))
            case ["", "pictures", number] if number.isdecimal():
                return review.picture(int(number)), "image/jpeg"
        raise LookupError(f"{path} is not here")

    def _post(self, review: Review) -> tuple[bytes, str]:
        body = self._body()
        match self.path.split("/"):
            case ["", "api", "undo"]:
                return _json(review.undo())
            case ["", "api", "export"]:
                return _json(review.export())
            case ["", "api", "export", form]:
                return _json(review.export_lines(form))
            case ["", "api", "import"]:
                return _json(review.import_lines(body))
            case ["", "api", "frames", number, "verdicts"] if number.isdecimal():
                return _json(review.judge(int(number), body))
            case ["", "api", "frames", number, "lines"] if number.isdecimal():
                return _json(review.correct(int(number), body))
        raise LookupError(f"{self.path} is not here")

    def _read_body(self) -> None:
        """Read the whole body. Raises RefusedError where nobody can tell its end, or it is too long."""
        lengths = self.headers.get_all("Content-Length", ["0"])
        if "Transfer-Encoding" in self.headers or len(lengths) > 1 or not LENGTH.fullmatch(lengths[0]):
            raise RefusedError(HTTPStatus.BAD_REQUEST, "expected one Content-Length, a number of bytes")
        if (length := int(lengths[0])) > LARGEST_REQUEST:
            self.rfile.read(min(length, DROPPED))  # a sender that is cut off does not get to read the answer
            raise RefusedError(
                HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"expected at most {LARGEST_REQUEST} bytes"
            )
        self._text = self.rfile.read(length)

    def _body(self) -> Any:
        """Return the JSON that was sent; another site's form cannot send that type."""
        if self.headers.get_content_type() != JSON:
            raise RefusedError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, f"expected {JSON}")
        try:
            return json.loads(self._text)
        except RecursionError:
            raise ValueError("the JSON is too deep") from None

    def _send_error(self, status: HTTPStatus, error: Exception) -> None:
        content, kind = _json({"error": one_line(error)[:LONGEST_ERROR]})
        self.close_connection = True  # what follows a request that was refused is not asked by our page
        self._send(status, content, kind)

    def _send(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        self.send_response(status)
        for name, value in {**HEADERS, "Content-Type": kind, "Content-Length": str(len(content))}.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)


def _json(value: Any) -> tuple[bytes, str]:
    return json.dumps(value, allow_nan=False).encode(), JSON
