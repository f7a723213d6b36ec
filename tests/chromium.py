"""Headless Chromium, driven by its DevTools protocol through two pipes: no driver, no port, no package."""

import base64
import itertools
import json
import os
import shutil
import subprocess
from contextlib import contextmanager

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-background-networking", "--disable-dev-shm-usage", "--no-first-run", "--remote-debugging-pipe",
)  # fmt: skip
FRAMES = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
HARMLESS = ("willReadFrequently", "GPU stall due to ReadPixels")


def program():
    """Path of a Chromium; None where there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Page:
    """A page of a browser, its messages and its requests.

    Attributes:
        messages: Texts of warnings, errors and exceptions of the page.
        requests: Addresses that the page has asked for.
    """

    def __init__(self, to, back):
        self._to, self._back, self._numbers, self._session = to, back, itertools.count(1), None
        self.messages, self.requests, self._loaded = [], [], False
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._to.write(json.dumps(message).encode() + b"\0")
        while (answer := self._next()).get("id") != number:
            pass
        assert "error" not in answer, answer
        return answer["result"]

    def open(self, address):
        """Open an address, and wait until the page says what it shows."""
        self._loaded = False
        self.call("Page.navigate", url=address)
        while not self._loaded:
            self._next()
        return self.shown()

    def run(self, script):
        """Value of a script in the page, a promise or not."""
        found = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def shown(self):
        """Wait until the page has drawn, and return its own account of the picture."""
        while not (shown := self.run(f"{FRAMES}.then(() => document.body?.dataset.shown || '')")):
            assert not self.messages, self.messages  # it may never draw
        return json.loads(shown)

    def change(self, script):
        """Run a script that changes the picture, and wait for the next one."""
        self.run(f"delete document.body.dataset.shown; {script}; 0")
        return self.shown()

    def size(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def key(self, name, **more):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, **more)

    def picture(self):
        """Screenshot, as the bytes of a PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def _next(self):
        letters = bytearray()
        while (letter := self._back.read(1)) != b"\0":
            assert letter, "Chromium has ended"
            letters += letter
        message = json.loads(letters)
        told = message.get("params", {})
        self._loaded |= message.get("method") == "Page.loadEventFired"
        if message.get("method") == "Network.requestWillBeSent":
            self.requests.append(told["request"]["url"])
        texts = {
            "Runtime.exceptionThrown": lambda: json.dumps(told["exceptionDetails"]),
            "Runtime.consoleAPICalled": lambda: json.dumps(told["args"]),
            "Log.entryAdded": lambda: told["entry"]["text"],
        }
        if message.get("method") in texts:
            text = texts[message["method"]]()
            if not any(words in text for words in HARMLESS):
                self.messages.append(text)
        return message


@contextmanager
def page(folder):
    """Open an empty page in a browser of its own, whose profile is in a folder."""
    (to_read, to_write), (back_read, back_write) = os.pipe(), os.pipe()
    # Chromium reads from file 3 and writes to file 4; bash names them so, whatever numbers they have here.
    start = f'exec "$@" 3<&{to_read} 4>&{back_write}'
    command = ["bash", "-c", start, "bash", program(), *FLAGS, f"--user-data-dir={folder}", "about:blank"]
    quiet = subprocess.DEVNULL
    browser = subprocess.Popen(command, pass_fds=(to_read, back_write), stdout=quiet, stderr=quiet)
    os.close(to_read)
    os.close(back_write)
    to, back = open(to_write, "wb", buffering=0), open(back_read, "rb")  # noqa: SIM115
    try:
        yield Page(to, back)
    finally:
        to.close()
        browser.terminate()
        browser.wait()
        back.close()
