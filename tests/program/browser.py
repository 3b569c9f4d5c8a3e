# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""A page in headless Chromium while it lives: told what to do by the DevTools protocol, over a pair of pipes."""
import base64
import json
import os
import pathlib
import select
import shutil
import subprocess
import sys
import time

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def pictures_folder():
    """Takes --pictures FOLDER off the command line and makes the folder; None without it."""
    if "--pictures" not in sys.argv:
        return None
    at = sys.argv.index("--pictures")
    folder = pathlib.Path(sys.argv[at + 1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    del sys.argv[at:at + 2]
    return folder


class Browser:
    """One tab. `complaints` holds what came on its console, and errors of scripts."""

    def __init__(self, folder):
        to_browser, self.requests = os.pipe()
        self.answers, from_browser = os.pipe()
        # Chromium reads from 3 and writes to 4, whatever those are here.
        start = f'exec "$0" "$@" 3<&{to_browser} 4>&{from_browser}'
        self.process = subprocess.Popen(
            ["bash", "-c", start, CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
             "--remote-debugging-pipe", f"--user-data-dir={folder}", "about:blank"],
            pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.received, self.number, self.session, self.complaints = b"", 0, None, []
        tab = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=tab, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def close(self):
        # By itself, with all its processes: one that is killed leaves some that still write into the profile.
        self.session = None
        try:
            self.call("Browser.close")
            self.process.wait(10)
        except (OSError, EOFError, TimeoutError, subprocess.TimeoutExpired):
            self.process.kill()
        self.process.wait()
        os.close(self.requests)
        os.close(self.answers)

    def message(self, until):
        """The next from the browser."""
        while b"\0" not in self.received:
            if not select.select([self.answers], [], [], max(0, until - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            part = os.read(self.answers, 1 << 16)
            if not part:
                raise EOFError("the browser has ended")
            self.received += part
        text, self.received = self.received.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **params):
        self.number += 1
        request = {"id": self.number, "method": method, "params": params}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.requests, json.dumps(request).encode() + b"\0")
        until = time.monotonic() + 30
        while True:
            message = self.message(until)
            if message.get("method") == "Runtime.exceptionThrown" or message.get("method") == "Runtime.consoleAPICalled":
                self.complaints.append(json.dumps(message["params"]))
            elif message.get("method") == "Log.entryAdded":
                self.complaints.append(message["params"]["entry"]["text"])
            elif message.get("id") == self.number:
                assert "error" not in message, (method, message["error"])
                return message["result"]

    def show(self, width, height, dark=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def open(self, url):
        self.call("Page.navigate", url=url)

    def value(self, expression):
        """What a script of one expression gives, as json; None where it fails, as in a page that is not there yet."""
        result = self.call("Runtime.evaluate", expression=f"JSON.stringify({expression})", awaitPromise=True)["result"]
        return json.loads(result["value"]) if result.get("type") == "string" else None

    def wait_for(self, expression, seconds=30):
        until = time.monotonic() + seconds
        while not self.value(expression):
            if time.monotonic() > until:
                raise TimeoutError(expression)
            time.sleep(0.1)

    def picture(self, file):
        """Of the whole page."""
        shot = self.call("Page.captureScreenshot", captureBeyondViewport=True)
        file.write_bytes(base64.b64decode(shot["data"]))
