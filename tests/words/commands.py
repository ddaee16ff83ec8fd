#!/usr/bin/env python3
"""Runs the commands of README and guides as a reader would, and checks that they work.

  commands.py BIN PAGE…      BIN: the folder of built programs; PAGE: a Markdown file

The word behind ``` says what to do with a block:
  sh           runs; it must end with exit code 0 within two minutes
  sh server    a mirage-server that stays up until the next one, or the end of the page
  sh window    a viewer in a window; it runs under a virtual display for a few frames
  sh lines     a command a line: servers and viewers as above, others to their end
  console      does not run; a line <!-- not run: REASON --> stands before it
Blocks run in a folder with what a clone has, a small scene.glb and a token.txt. Exit code 1 if a
command fails; 77 without any page to run."""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENE = os.path.join(ROOT, "tests/data/assets/objects")
LONGEST_S = 120


class Failed(Exception):
    pass


def blocks(page):
    """(line, info, text) of each fenced block, and complaints about unmarked ones."""
    with open(page, encoding="utf-8") as file:
        lines = file.read().split("\n")
    i = 0
    while i < len(lines):
        opened = re.match(r"\s*```(.*)$", lines[i])
        if not opened:
            i += 1
            continue
        begin, info, text = i, opened.group(1).strip(), []
        i += 1
        while i < len(lines) and not lines[i].lstrip().startswith("```"):
            text.append(lines[i])
            i += 1
        i += 1
        if info == "" or info == "bash":
            raise Failed(f"{page}:{begin + 1}: a block without a word behind ``` (sh, console, text, …)")
        if info == "console" and not (begin > 0 and re.match(r"\s*<!-- not run: \S.* -->", lines[begin - 1])):
            raise Failed(f"{page}:{begin + 1}: a console block without <!-- not run: REASON --> before it")
        yield begin + 1, info, "\n".join(text)


def make_folder(binaries):
    folder = tempfile.mkdtemp(prefix="mirage-words-")
    for name in ("scripts", "docs", "packaging", "tests"):
        os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
    os.makedirs(os.path.join(folder, "build/release"))
    os.symlink(os.path.abspath(binaries), os.path.join(folder, "build/release/bin"))
    models = sorted(n for n in os.listdir(SCENE) if n.endswith(".glb"))
    shutil.copy(os.path.join(SCENE, models[0]), os.path.join(folder, "scene.glb"))
    with open(os.path.join(folder, "token.txt"), "w", encoding="utf-8") as file:
        file.write("a-token-for-the-guides name=reader\n")
    return folder


class Server:
    """A server in the background; its log says when it is ready."""

    def __init__(self, folder, command):
        self.log = os.path.join(folder, "server.log")
        with open(self.log, "w", encoding="utf-8") as out:
            self.process = subprocess.Popen(
                ["bash", "-c", "exec " + command.strip()], cwd=folder, stdout=out, stderr=subprocess.STDOUT)
        end = time.monotonic() + LONGEST_S
        while not re.search(r"^ready ", self.text(), re.M):
            if self.process.poll() is not None or time.monotonic() > end:
                self.stop()
                raise Failed("the server does not get ready:\n" + self.text())
            time.sleep(0.1)

    def text(self):
        with open(self.log, encoding="utf-8", errors="replace") as file:
            return file.read()

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def run(folder, text):
    try:
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, timeout=LONGEST_S,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired as late:
        raise Failed(f"still running after {LONGEST_S} s") from late
    if done.returncode != 0:
        raise Failed(f"exit code {done.returncode}:\n" + done.stdout.decode(errors="replace")[-2000:])


def in_window(text):
    """The same viewer for a few frames under a virtual display; None where there is none."""
    if not shutil.which("xvfb-run"):
        return None
    return "xvfb-run -a " + " ".join(text.replace("\\\n", " ").split()) + " --frames 5"


def kind_of(line):
    """How a line of a block of lines runs."""
    if "/mirage-server " in line:
        return "sh server"
    return "sh window" if "/mirage-view " in line and "--offscreen" not in line else "sh"


def parts(info, text):
    """(info, command) of each command of a block."""
    if info != "sh lines":
        return [(info, text)]
    lines = [re.sub(r"\s+#.*", "", line) for line in text.split("\n")]
    return [(kind_of(line), line) for line in lines if line.strip()]


def run_page(binaries, page):
    folder, server, count, skipped = make_folder(binaries), None, 0, 0
    try:
        commands = [(line, *part) for line, info, text in blocks(page) for part in parts(info, text)]
        for line, info, text in commands:
            try:
                if info == "sh server":
                    if server:
                        server.stop()
                    server = Server(folder, text)
                elif info == "sh window":
                    command = in_window(text)
                    if command is None:
                        skipped += 1
                        continue
                    run(folder, command)
                elif info == "sh":
                    run(folder, text)
                else:
                    continue
            except Failed as failed:
                raise Failed(f"{page}:{line}: {text}\n  {failed}") from failed
            count += 1
    finally:
        if server:
            server.stop()
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{os.path.relpath(page, ROOT)}: {count} commands run" + (f", {skipped} need xvfb-run" if skipped else ""))


def main():
    failures = 0
    for page in sys.argv[2:]:
        try:
            run_page(sys.argv[1], page)
        except Failed as failed:
            failures += 1
            print(f"FAILED {failed}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
