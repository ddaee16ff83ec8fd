"""Tests packaging/python/mirage.py with the shipped server: notebook.py SERVER SOURCE_FOLDER."""

import os
import struct
import sys
import time
import unittest

SERVER, SOURCE = sys.argv.pop(1), sys.argv.pop(1)
sys.path.insert(0, os.path.join(SOURCE, "packaging", "python"))
sys.dont_write_bytecode = True
import mirage  # noqa: E402


class Notebook(unittest.TestCase):
    def test_a_scene_is_served_shown_and_drawn(self):
        with mirage.serve("builtin:knot", program=SERVER) as scene:
            png = scene.picture(size=(64, 48), samples=1)
            self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(struct.unpack(">II", png[16:24]), (64, 48))
            other = scene.picture(eye=(0, 0, 9), look=(0, 0, 0), size=(64, 48), samples=1)
            self.assertNotEqual(png, other)
            self.assertEqual(scene.picture(format="webp", size=(32, 32))[8:12], b"WEBP")
            self.assertIn(f'src="{scene.url}/"', scene._repr_html_())
            again = mirage.connect(scene.url)
            self.assertEqual(again.picture(size=(64, 48), samples=1), png)
            process = scene._process
        self.assertIsNotNone(process.poll(), "the server has ended")
        with self.assertRaisesRegex(mirage.MirageError, "does not answer"):
            scene.picture()

    def test_what_is_wrong_is_said(self):
        with self.assertRaisesRegex(mirage.MirageError, "no such|not|cannot"):
            mirage.serve("/nowhere/model.glb", program=SERVER)
        with mirage.serve("builtin:knot", program=SERVER) as scene:
            with self.assertRaisesRegex(mirage.MirageError, "size is not"):
                scene.picture(size=(0, 5))
            with self.assertRaisesRegex(mirage.MirageError, "eye and look"):
                scene.picture(eye=(1, 2, 3))
        with self.assertRaisesRegex(mirage.MirageError, "there is no program"):
            mirage.serve("builtin:knot", program="/nowhere/mirage-server")

    def test_a_slow_start_is_given_up(self):
        began = time.monotonic()
        with self.assertRaisesRegex(mirage.MirageError, "not ready within"):
            mirage.serve("builtin:museum", program=SERVER, timeout=0.5)
        self.assertLess(time.monotonic() - began, 10)


unittest.main()
