"""Chromium for tests of pages: whether it is there, how it is started, what it asked for."""

import http.server
import json
import shutil
import threading
import time
from contextlib import contextmanager
from functools import partial
from importlib.util import find_spec

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
PHONE = {"width": 390, "height": 844, "deviceScaleFactor": 2.0, "mobile": True}
TIMEOUT = 300.0  # seconds, for what hangs
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",  # draws in space without a graphics card
    "--disable-quic",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",  # other hosts are asked for, but not reached
)
needed = pytest.mark.skipif(
    not (CHROMIUM and DRIVER and find_spec("selenium")), reason="needs Chromium, chromedriver and the extra docs"
)


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves files and keeps no log."""

    extensions_map = {**http.server.SimpleHTTPRequestHandler.extensions_map, ".js": "text/javascript"}  # noqa: RUF012

    def log_message(self, *_):
        pass


@contextmanager
def served(folder):
    """Address of a folder that is served on this machine."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


@contextmanager
def started(width, profile):
    """Chromium with a window of a width [px] in the dark theme; the width of `PHONE` is a phone.  profile : a new folder."""
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, f"--user-data-dir={profile}", f"--window-size={width},900"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(DRIVER))
    driver.set_script_timeout(TIMEOUT)
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
    show_in(driver, width)
    driver.get("about:blank")  # some versions start with a page for new tabs, which asks for hundreds of files
    try:
        yield driver
    finally:
        driver.quit()


def show_in(browser, width):
    """Give the page a window of a width [px]; the width of `PHONE` is a phone, with two pixels for one and touch."""
    is_phone = width == PHONE["width"]
    window = PHONE if is_phone else {"width": width, "height": 900, "deviceScaleFactor": 1.0, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", window)
    browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": is_phone})


@contextmanager
def without(browser, *addresses):
    """Pages do not get what is at these addresses, with * for anything."""
    browser.execute_cdp_cmd("Network.enable", {})
    browser.execute_cdp_cmd("Network.setBlockedURLs", {"urls": [*addresses]})
    try:
        yield
    finally:
        browser.execute_cdp_cmd("Network.setBlockedURLs", {"urls": []})


def wait_until(browser, condition):
    """Wait until a condition in JavaScript holds; slow machines take their time."""
    deadline = time.monotonic() + TIMEOUT
    while not browser.execute_script(f"return Boolean({condition})"):
        assert time.monotonic() < deadline, (condition, errors(browser))
        time.sleep(0.02)


def messages(browser, method):
    """Parameters of the messages of one kind since the last call."""
    logged = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    return [each["params"] for each in logged if each["method"] == method]


def errors(browser):
    """What the console has of errors since the last call, but for the icon that a browser looks for."""
    logged = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    return [message for message in logged if "favicon.ico" not in message]
