"""Controls Chromium through its driver, by the WebDriver protocol."""

import base64
import contextlib
import json
import re
import subprocess
import tempfile
import urllib.error
import urllib.request

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync"]
DOWN, UP = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}


def move(point, milliseconds=0):
    """A move of the mouse or a finger to a point of the window."""
    return {"type": "pointerMove", "x": round(point[0]), "y": round(point[1]), "duration": milliseconds}


class Browser:
    """A session of Chromium."""

    def __init__(self, address, folder):
        self.address = address
        options = {"args": [*FLAGS, f"--user-data-dir={folder}"]}
        wanted = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        self.address += "/session/" + self.post("/session", capabilities={"alwaysMatch": wanted})["sessionId"]

    def request(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"].splitlines()[0]) from error

    def post(self, path, **body):
        return self.request("POST", path, body)

    def run(self, script, *arguments):
        return self.post("/execute/sync", script=script, args=arguments)

    def wait(self, script):
        """Runs a script and waits for the value that it passes to its last argument, a callback."""
        return self.post("/execute/async", script=script, args=[])

    def developer(self, command, **parameters):
        return self.post("/goog/cdp/execute", cmd=command, params=parameters)

    def log(self, kind):
        return self.post("/se/log", type=kind)

    def addresses(self, event, part):
        """Addresses of all requests or responses since the last call."""
        messages = [json.loads(entry["message"])["message"] for entry in self.log("performance")]
        return [message["params"][part]["url"] for message in messages if message["method"] == f"Network.{event}"]

    def resize(self, size):
        self.developer("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1,
                       mobile=False)

    def prefer(self, **features):
        names = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.developer("Emulation.setEmulatedMedia", features=names)

    def open(self, address):
        # The browser would not reload a page whose address differs only in its hash.
        self.post("/url", url="about:blank")
        self.post("/url", url=address)

    def act(self, *sources):
        self.post("/actions", actions=sources)

    def mouse(self, *actions):
        self.act({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions})

    def press(self, *keys):
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.act({"type": "key", "id": "keyboard", "actions": actions})

    def wheel(self, at, pixels):
        scroll = {"type": "scroll", "x": at[0], "y": at[1], "deltaX": 0, "deltaY": pixels, "duration": 0}
        self.act({"type": "wheel", "id": "wheel", "actions": [scroll]})

    def picture(self):
        return base64.b64decode(self.request("GET", "/screenshot"))

    def part(self, corner, side):
        """A picture of a square in the window."""
        clip = {"x": corner[0], "y": corner[1], "width": side, "height": side, "scale": 1}
        return base64.b64decode(self.developer("Page.captureScreenshot", clip=clip)["data"])

    def print(self):
        return base64.b64decode(self.post("/print"))


@contextlib.contextmanager
def browser():
    """Chromium with an empty profile; the browser and its driver end with the block."""
    driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        port = next(found[1] for line in driver.stdout if (found := re.search(r"started successfully on port (\d+)", line)))
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
            session = Browser(f"http://127.0.0.1:{port}", folder)
            try:
                yield session
            finally:
                session.request("DELETE", "")
    finally:
        driver.terminate()
        driver.wait()
