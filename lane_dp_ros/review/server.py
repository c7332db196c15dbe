# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The page's server: this machine only."""

from __future__ import annotations

import errno
import sys
from functools import partial
from http.server import ThreadingHTTPServer
from typing import Any

from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.review.handler import ADDRESS, GONE, Handler, Site
from lane_dp_ros.review.review import Review


class ReviewServer(ThreadingHTTPServer):
    """Serves one review; bound to its port as soon as it is made.

    Raises CommandError when the port is taken.
    """

    daemon_threads = True  # of connections; a browser leaves them open

    def __init__(self, port: int) -> None:
        self.site = Site()
        try:
            super().__init__((ADDRESS, port), partial(Handler, self.site))
        except OSError as error:
            hint = "--port names another one, 0 any that is free"
            raise CommandError(f"cannot serve on port {port}: {one_line(error)}; {hint}") from None
        self.site.port = self.server_port

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://{ADDRESS}:{self.server_port}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Keep quiet about connections that were closed; show any other error that nobody expected."""
        error = sys.exc_info()[1]
        # An interrupt in the very moment of accepting a connection closes it before its thread looks at it.
        closed_here = isinstance(error, OSError) and error.errno == errno.EBADF
        if not closed_here and not isinstance(error, GONE):
            super().handle_error(request, client_address)

    def serve(self, review: Review) -> None:
        """Answer until an exception such as KeyboardInterrupt ends it; the last request is then answered."""
        self.site.review = review
        try:
            self.serve_forever(poll_interval=0.05)
        finally:
            self.site.requests.close()
