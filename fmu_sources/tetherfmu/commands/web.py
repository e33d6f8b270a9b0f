"""Write the page for flights in the browser, and serve it on this machine."""

import errno
import sys
from functools import partial
from http import HTTPStatus
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder, number
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.libraries import webassembly
from tetherfmu.web import page

HERE = "127.0.0.1"  # only this machine reaches the server
TYPES = {".js": "text/javascript", ".wasm": "application/wasm"}  # overrides the system's types


class Handler(SimpleHTTPRequestHandler):
    """Serves the present files of a folder, without a log."""

    extensions_map = {**SimpleHTTPRequestHandler.extensions_map, **TYPES}  # noqa: RUF012 (as in its base)

    def send_head(self):
        """A file of the folder, or its page; no directory listing, and no links that lead out of it."""
        root = Path(self.directory).resolve()
        try:
            place = Path(self.translate_path(self.path)).resolve()
            is_here = place == root or (place.is_file() and place.is_relative_to(root))
        except (OSError, ValueError):  # a path that no file can have
            is_here = False
        if not is_here:
            self.send_error(HTTPStatus.NOT_FOUND)
            return None
        return super().send_head()

    def list_directory(self, _):
        """Nothing of a folder without a page."""
        self.send_error(HTTPStatus.NOT_FOUND)

    def end_headers(self):
        """A page that is written again is loaded again."""
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()

    def log_message(self, *_):
        """Nothing."""


def server_of(place, port):
    """A server of a folder at a port of this machine, 0 for any free one; WrongUse if the port is in use."""
    try:
        return ThreadingHTTPServer((HERE, port), partial(Handler, directory=place))
    except OSError as error:
        if error.errno not in (errno.EADDRINUSE, errno.EACCES):
            raise
        raise WrongUse(f"port {port} cannot be used ({error.strerror}); choose another --port, or none") from None


def serve(server):
    """Serve until Ctrl-C."""
    try:
        print(f"http://{HERE}:{server.server_port}/  until Ctrl-C", flush=True)
        server.serve_forever()
    except KeyboardInterrupt:
        print(file=sys.stderr)  # after the ^C of the terminal
    finally:
        server.server_close()


@command
def main(arguments=None, prog="tetherfmu web"):
    """Write the page; with --serve also serve it until Ctrl-C. Returns the exit status."""
    parser = Parser(prog=prog)
    option = parser.add_argument
    option("--out", default="web", type=folder, metavar="DIR", help="folder of the page (default: web)")
    option("--serve", action="store_true", help="also serve it on this machine, until Ctrl-C; a browser needs a server")
    about = "with --serve: port of the server (default: a free one)"
    option("--port", type=number(1, 65535, whole=True), metavar="P", help=about)
    given = parser.parse_args(arguments)
    if given.port and not given.serve:
        parser.error("--port requires --serve")
    server = server_of(given.out, given.port or 0) if given.serve else None
    for path in page.write(given.out, webassembly.browser_file().read_bytes()):
        print(f"{path}  {path.stat().st_size / 1000:.0f} kB")
    if server:
        serve(server)
    return 0
