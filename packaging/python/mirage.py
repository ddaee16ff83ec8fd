"""Mirage in notebooks: serves a 3D file, shows it, and gets pictures of it.

    import mirage
    scene = mirage.serve("model.glb")
    scene                                     # in IPython: the viewer in a frame
    png = scene.picture(eye=(3, 2, 5), look=(0, 1, 0), size=(640, 360))
    scene.close()

It needs the program mirage-server and Python's standard library, 3.8 or later.
"""

import html
import os
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.parse
import urllib.request

__all__ = ["MirageError", "Scene", "connect", "serve"]


class MirageError(Exception):
    """The server did not start, or refused what it was asked for. The text says why."""


def serve(scene, *options, program="mirage-server", timeout=120.0):
    """Starts a server for a file, or for a built-in scene such as "builtin:forest".

    scene: a path, or a name that mirage-server knows.
    options: further options of mirage-server, such as "--no-geometry".
    program: its path, or a name on PATH.
    timeout: seconds to wait until the server is ready.
    Returns a Scene, which ends the server with close(), with `with`, or when it is garbage.
    Raises MirageError if there is no mirage-server, or if it cannot serve the scene.
    """
    found = shutil.which(program)
    if not found:
        raise MirageError(f"there is no program {program}; serve(..., program=PATH) names it")
    folder = tempfile.mkdtemp(prefix="mirage-")
    log_path = os.path.join(folder, "log")
    command = [found, os.fspath(scene), "--listen", "127.0.0.1:0", *options]
    with open(log_path, "wb") as log:
        try:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        except OSError as error:
            shutil.rmtree(folder, ignore_errors=True)
            raise MirageError(f"{found} does not start: {error}") from error
    end = time.monotonic() + timeout
    while True:
        with open(log_path, "r", encoding="utf-8", errors="replace") as log:
            lines = log.read().splitlines()
        ready = [line for line in lines if line.startswith("ready url=")]
        if ready:
            url = ready[0].split("url=", 1)[1].split()[0]
            return Scene(url.replace("ws", "http", 1), process=process, folder=folder)
        failed = process.poll() is not None
        if failed or time.monotonic() > end:
            process.kill()
            process.wait()
            shutil.rmtree(folder, ignore_errors=True)
            why = "\n".join(lines[-3:]) or "it says nothing"
            raise MirageError(why if failed else f"not ready within {timeout:g} s: {why}")
        time.sleep(0.05)


def connect(url, token=None):
    """Returns a Scene of a server that runs already, such as http://build-box:9870."""
    return Scene(url, token=token)


class Scene:
    """A served scene. In IPython it shows itself as the viewer in a frame."""

    def __init__(self, url, token=None, process=None, folder=None):
        self.url = url.rstrip("/")
        self.size = (800, 450)  # of the frame, px
        self._token = token
        self._process = process
        self._folder = folder

    def picture(self, eye=None, look=None, size=(640, 360), format="png", samples=2, light=None,
                fov=60, timeout=120.0):
        """Returns the full render as the bytes of an image file.

        eye, look: where the eye is, and a point that it looks at: three numbers each, m. Without
            them the picture is seen from the scene's home view.
        size: width and height, px.
        format: "png" (exact), "webp" or "jpeg".
        samples: of a pixel, on each side: 1 to 4.
        light: azimuth and elevation of the sun, degrees; None: the scene's own light.
        fov: vertical field of view, degrees.
        timeout: seconds to wait.
        Raises MirageError if the server refuses, or is not there.
        """
        values = {"size": "x".join(str(int(n)) for n in size), "format": format,
                  "samples": str(samples), "fov": repr(float(fov))}
        for name, numbers in (("eye", eye), ("look", look), ("light", light)):
            if numbers is not None:
                values[name] = ",".join(repr(float(n)) for n in numbers)
        request = urllib.request.Request(f"{self.url}/v1/picture?{urllib.parse.urlencode(values)}")
        if self._token:
            request.add_header("Authorization", f"Bearer {self._token}")
        try:
            with urllib.request.urlopen(request, timeout=timeout) as answer:
                return answer.read()
        except urllib.error.HTTPError as error:
            raise MirageError(error.read(1000).decode("utf-8", "replace").strip()) from error
        except OSError as error:
            raise MirageError(f"{self.url} does not answer: {error}") from error

    def close(self):
        """Ends the server that serve() has started."""
        process, self._process = self._process, None
        if process:
            process.terminate()
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        folder, self._folder = self._folder, None
        if folder:
            shutil.rmtree(folder, ignore_errors=True)

    def _repr_html_(self):
        width, height = self.size
        return (f'<iframe src="{html.escape(self.url, quote=True)}/" width="{int(width)}" '
                f'height="{int(height)}" style="border:0" allowfullscreen></iframe>')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        try:
            self.close()
        except Exception:  # the interpreter may be ending
            pass
