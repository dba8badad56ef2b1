# SPDX-License-Identifier: BSD-3-Clause
"""A headless chromium, driven through the DevTools protocol over a pipe: no package beyond it.

    with Browser() as browser:
        page = browser.open(path, width=390, height=844)
        page.run("document.title")
"""
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time

from program import PATIENCE_s


def find():
    return shutil.which("chromium") or shutil.which("chromium-browser")


# Where --remote-debugging-pipe reads and writes.
AS_3_AND_4 = """import os, sys
reading, writing = (os.dup(int(number)) for number in sys.argv[1:3])
os.dup2(reading, 3)
os.dup2(writing, 4)
os.set_inheritable(3, True)  # dup2 does nothing if it has this number already
os.set_inheritable(4, True)
os.execv(sys.argv[3], sys.argv[3:])"""

# WebGL without a graphics card.
SOFTWARE_WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


class Browser:
    def __init__(self, options=("--disable-gpu",)):
        self.options = options

    def __enter__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self.out = os.pipe()
        self.into, from_browser = os.pipe()

        # A program of its own makes them 3 and 4: in a child of this interpreter, the collector may close files that have
        # these numbers here.
        self.process = subprocess.Popen(
            [sys.executable, "-c", AS_3_AND_4, str(to_browser), str(from_browser),
             find(), "--headless", "--no-sandbox", *self.options, "--disable-dev-shm-usage",
             "--remote-debugging-pipe", f"--user-data-dir={self.profile.name}", "about:blank"],
            pass_fds=(to_browser, from_browser), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.buffer, self.events = 0, b"", []
        return self

    def __exit__(self, *_):
        try:
            self.send("Browser.close")
            self.process.wait(PATIENCE_s)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.out)
        os.close(self.into)
        self.profile.cleanup()

    def message(self, until):
        """The next message; messages end with a zero byte."""
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.into], [], [], max(0.0, until - time.monotonic()))
            part = os.read(self.into, 1 << 20) if ready else b""
            if not part:
                raise RuntimeError("the browser is silent" if not ready else "the browser ended")
            self.buffer += part
        first, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(first)

    def send(self, method, session=None, **parameters):
        """The response to a command; events that arrive before it are kept."""
        self.number += 1
        command = {"id": self.number, "method": method, "params": parameters}
        if session:
            command["sessionId"] = session
        data = json.dumps(command).encode() + b"\0"
        while data:
            data = data[os.write(self.out, data):]
        until = time.monotonic() + PATIENCE_s
        while True:
            answer = self.message(until)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error'].get('message')}")
                return answer.get("result", {})
            self.events.append(answer)

    def wait_for(self, name):
        until = time.monotonic() + PATIENCE_s
        while not any(event.get("method") == name for event in self.events):
            self.events.append(self.message(until))

    def open(self, path, width, height, dark=False):
        """Opens a file, or an address given as text."""
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, session)
        for domain in ("Page", "Runtime", "Network"):
            page.send(domain + ".enable")
        page.send("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=width < 700)
        if dark:
            page.send("Emulation.setEmulatedMedia",
                      features=[{"name": "prefers-color-scheme", "value": "dark"}])
        self.events.clear()
        page.send("Page.navigate", url=path if isinstance(path, str) else path.resolve().as_uri())
        self.wait_for("Page.loadEventFired")
        return page


class Page:
    def __init__(self, browser, session):
        self.browser, self.session = browser, session

    def send(self, method, **parameters):
        return self.browser.send(method, self.session, **parameters)

    def run(self, script):
        """The value of an expression; its exceptions are raised."""
        answer = self.send("Runtime.evaluate", expression=script, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(str(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def press(self, key, code):
        """Presses a key; Enter includes its text."""
        text = {"text": "\r"} if key == "Enter" else {}
        for kind in ("keyDown", "keyUp"):
            self.send("Input.dispatchKeyEvent", type=kind, key=key, code=key,
                      windowsVirtualKeyCode=code, **(text if kind == "keyDown" else {}))

    def move(self, x, y):
        """Moves the mouse to a point of the window."""
        self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def drag(self, x, y, to_x, to_y):
        """Presses the left button at the first point and releases it at the second."""
        self.move(x, y)
        self.send("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", clickCount=1)
        for part in (0.5, 1.0):
            self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x + part * (to_x - x),
                      y=y + part * (to_y - y), button="left", buttons=1)
        self.send("Input.dispatchMouseEvent", type="mouseReleased", x=to_x, y=to_y, button="left", clickCount=1)

    def type(self, text):
        """Types into the element that has the focus."""
        self.send("Input.insertText", text=text)

    def wait(self, condition):
        """Waits until an expression is true, at most a minute."""
        return self.run(f"""new Promise(done => {{
            const until = performance.now() + 60000;
            const look = () => ({condition}) ? done(true)
                : performance.now() > until ? done(false) : setTimeout(look, 20);
            look(); }})""")

    def errors(self):
        """Exceptions of scripts and messages of console.error since the page was loaded."""
        self.run("1")  # all earlier events have arrived when this returns
        found = [str(e["params"]["exceptionDetails"]) for e in self.browser.events
                 if e.get("method") == "Runtime.exceptionThrown"]
        return found + [str(e["params"]["args"]) for e in self.browser.events
                        if e.get("method") == "Runtime.consoleAPICalled"
                        and e["params"]["type"] == "error"]

    def requests(self):
        """Addresses that the page requested, except its own address and data URLs."""
        self.run("1")
        urls = [e["params"]["request"]["url"] for e in self.browser.events
                if e.get("method") == "Network.requestWillBeSent"]
        return [url for url in urls if not url.startswith(("data:", "file:"))]
