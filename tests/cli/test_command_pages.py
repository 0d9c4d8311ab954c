"""Manual pages and completions are generated from the command, and the guide's tables agree with it.

test_command_pages.py COMMAND
"""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "packaging/command_pages"
COMMAND = ""


class CommandPages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.out = Path(folder.name)
        subprocess.run([sys.executable, PAGES, COMMAND, "--install", cls.out], check=True)

    def completed(self, *words):
        """The lines that bash offers for the last word."""
        script = (
            'source "$1"; shift; COMP_WORDS=(pellucid "$@"); COMP_CWORD=$#; _pellucid; '
            'printf "%s\\n" "${COMPREPLY[@]}"'
        )
        file = self.out / "share/bash-completion/completions/pellucid"
        command = ["bash", "-c", script, "bash", file, *words]
        return subprocess.check_output(command, text=True, cwd=self.out).split("\n")[:-1]

    def test_the_guide_is_up_to_date(self):
        subprocess.run([sys.executable, PAGES, COMMAND, "--check"], check=True)

    def test_bash(self):
        for words, expected in (
            ("sha", "shade share"),  # a subcommand, and a folder
            ("lut sp", "specular"),
            ("curvature m.ply --smooth-weights a", "area"),
            ("shade g.exr --show spec", "specular"),
            # Files are offered where an option takes one, and nowhere else. The folder here is `share`.
            ("shade g.exr --scene sh", "share"),
            ("shade g.exr --device ", "cpu gpu accelerator"),
            ("lut shadow --profile skin-d", "skin-dark"),
            ("demo -o out --size ", ""),
            ("demo --height ", ""),
            ("bench --only ", ""),
            ("demo --subdivide ", ""),
            ("bench -o compare --onl", "--only"),  # the file is no subcommand
        ):
            self.assertEqual(self.completed(*words.split(" ")), expected.split() or [""], words)
        with tempfile.NamedTemporaryFile(dir=self.out, prefix="a name ") as file:
            self.assertEqual(self.completed("curvature", "a"), [Path(file.name).name])
        self.assertIn("--smooth-weights", self.completed("curvature", "m.ply", "--smooth-w"))
        self.assertNotIn("--smooth", self.completed("shade", "--s"))
        self.assertIn("share", self.completed("lut", "shadow", "--profile", ""))

    def test_other_shells_can_read_theirs(self):
        for shell, file in (
            ("zsh", "zsh/site-functions/_pellucid"),
            ("fish", "fish/vendor_completions.d/pellucid.fish"),
        ):
            path = self.out / "share" / file
            self.assertIn("smooth-weights", path.read_text())
            if shutil.which(shell):
                subprocess.run([shell, "-n", path], check=True)

    def test_manual_pages(self):
        pages = sorted(p.name for p in (self.out / "share/man/man1").iterdir())
        self.assertIn("pellucid.1", pages)
        self.assertIn("pellucid-lut-curvature.1", pages)
        shade = (self.out / "share/man/man1/pellucid-shade.1").read_text()
        self.assertIn("scene file (TOML)", shade)
        if shutil.which("groff"):
            command = ["groff", "-man", "-ww", "-z", *(self.out / "share/man/man1").iterdir()]
            read = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual((read.returncode, read.stderr), (0, ""))


if __name__ == "__main__":
    COMMAND = sys.argv.pop(1)
    unittest.main()
