"""Chromium without a window, driven by its DevTools protocol (https://chromedevtools.github.io/devtools-protocol/)."""

import base64
import json
import os
import shutil
import subprocess
import time
from contextlib import ExitStack

from websockets.sync.client import connect

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PATH = next(filter(None, map(shutil.which, NAMES)), None)
EVIL = "evil.example"  # a name that leads to this machine
WIDTH, HEIGHT = 1000, 700
WAIT = 90.0  # seconds, at most; pictures are drawn by the processor
_FLAGS = (
    *("--headless=new", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--mute-audio", "--no-first-run"),
    *("--remote-debugging-port=0", "--hide-scrollbars", "--disable-background-networking"),
    *("--disable-background-timer-throttling", "--disable-renderer-backgrounding"),
    f"--host-resolver-rules=MAP {EVIL} 127.0.0.1",
)


class Chromium:
    """A browser; `open` makes tabs."""

    def __init__(self, folder):
        root = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
        self._held = ExitStack()
        command = [PATH, *_FLAGS, *root, f"--user-data-dir={folder}", "about:blank"]
        log = self._held.enter_context((folder / "log").open("w+", encoding="utf-8"))
        self._process = subprocess.Popen(command, stderr=log, stdout=log)
        where = folder / "DevToolsActivePort"
        self._until(lambda: where.exists() and where.read_text().count("\n") == 1, "the browser")
        port, path = where.read_text().splitlines()
        self._socket = self._held.enter_context(connect(f"ws://127.0.0.1:{port}{path}", max_size=None))
        self._number, self.tabs = 0, {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._held.close()
        self._process.kill()
        self._process.wait()

    def open(self, url, width=WIDTH, height=HEIGHT):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.tabs[session] = tab = Tab(self, session, target)
        for domain in ("Page", "Runtime", "Log"):
            tab.call(f"{domain}.enable")
        tab.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        tab.go(url)
        return tab

    def call(self, method, session=None, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        self._socket.send(json.dumps(message | ({"sessionId": session} if session else {})))
        while True:
            answer = json.loads(self._socket.recv(WAIT))
            if answer.get("id") == self._number:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            if answer.get("sessionId") in self.tabs:
                self.tabs[answer["sessionId"]].hear(answer)

    def _until(self, happened, what):
        end = time.monotonic() + WAIT
        while not happened():
            assert time.monotonic() < end, f"waited in vain for {what}"
            time.sleep(0.05)


class Tab:
    """A tab: what is in it, and what its user does."""

    def __init__(self, browser, session, target):
        self._browser, self._session, self._target = browser, session, target
        self.errors = []

    def call(self, method, **parameters):
        return self._browser.call(method, self._session, **parameters)

    def go(self, url):
        self.call("Page.navigate", url=url)

    def close(self):
        self._browser.call("Target.closeTarget", targetId=self._target)
        del self._browser.tabs[self._session]

    def hear(self, event):
        what = event["params"]
        if event["method"] == "Runtime.exceptionThrown":
            self.errors.append(str(what["exceptionDetails"]))
        elif event["method"] == "Log.entryAdded" and what["entry"]["level"] == "error":
            self.errors.append(str(what["entry"]))
        elif event["method"] == "Runtime.consoleAPICalled" and what["type"] == "error":
            self.errors.append(str(what["args"]))

    def run(self, script):
        """Return what a script comes to, once it has, if it is a promise."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    @property
    def text(self):
        return self.run("document.body ? document.body.innerText : ''") or ""

    def until(self, happened, what):
        """Bring the tab to the front, as those behind draw nothing, and wait for something to happen."""
        self.call("Page.bringToFront")
        end = time.monotonic() + WAIT
        while not happened(self):
            assert time.monotonic() < end, f"waited in vain for {what}; the page says: {self.text[:500]}"
            time.sleep(0.05)

    def press(self, label):
        button = (
            f"[...document.querySelectorAll('button')].find(b => b.innerText.trim() === {label!r} && b.offsetParent)"
        )
        self.until(lambda tab: tab.run(f"!!{button}"), f"a button {label!r}")
        self.run(f"{button}.click()")

    def drag(self, start, end, release=True):
        """Press the mouse at a place and move it to another, as slowly as a hand."""
        self._mouse("mouseMoved", start, 0)
        self._mouse("mousePressed", start, 1)
        for part in (0.02, 0.05, *(k / 20 for k in range(2, 21))):
            self._mouse("mouseMoved", [a + part * (b - a) for a, b in zip(start, end, strict=True)], 1)
        if release:
            self.release(end)

    def release(self, at):
        self._mouse("mouseReleased", at, 0)

    def _mouse(self, kind, at, buttons):
        button = "left" if buttons or kind == "mouseReleased" else "none"
        self.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button=button, buttons=buttons, clickCount=1)
        time.sleep(0.05)

    def screenshot(self):
        self.call("Page.bringToFront")
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
