"""Tables in every format by the built command, read by third-party readers and compared with one another.

    read_tables.py PELLUCID WORK

PELLUCID is the command, WORK a folder that keeps a virtual environment with the readers. A reader that
cannot be installed is skipped with a message; then this ends with 77, as CTest knows it.
"""

import subprocess
import sys
import tempfile
import unittest
import venv
from pathlib import Path

COMMAND, work = sys.argv.pop(1), Path(sys.argv.pop(1)).resolve() / "readers"
if Path(sys.prefix).resolve() != work:
    if not (work / "complete").exists():
        venv.create(work, clear=True, with_pip=True)
        install = "-m pip --disable-pip-version-check install -q --only-binary :all:".split()
        for name in ("numpy", "pillow", "OpenEXR", "pyktx2"):
            found = subprocess.run([work / "bin/python", *install, name], capture_output=True)
            if found.returncode and name == "numpy":
                print("tests/foreign::packages_from_PyPI SKIPPED (pip cannot reach what the tests need)")
                sys.exit(77)
        (work / "complete").touch()
    sys.exit(subprocess.run([work / "bin/python", __file__, COMMAND, work.parent]).returncode)

import numpy as np  # noqa: E402

WIDTH, HEIGHT = 23, 14  # no multiples of 4


def reader(name):
    try:
        return __import__(name)
    except ImportError:
        raise unittest.SkipTest(f"{name} is not installed") from None


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    def table(self, name, encoding, size=f"{WIDTH}x{HEIGHT}"):
        path = Path(self.folder.name) / f"{size}-{name}"
        if not path.exists():
            options = f"--size {size} --axis root --radius-min 1 --radius-max 100 --encoding {encoding}"
            subprocess.check_output([COMMAND, "lut", "curvature", "-o", path, *options.split()])
        return str(path)

    def npy(self, encoding):
        return np.load(self.table(encoding + ".npy", encoding))

    def test_npy(self):
        full, half, coded = (self.npy(e) for e in ("float", "half", "faceworks8"))
        self.assertEqual((full.dtype, full.shape), (np.float32, (HEIGHT, WIDTH, 3)))
        self.assertTrue(np.array_equal(half, full.astype(np.float16)))
        self.assertEqual((coded.dtype, coded.shape), (np.uint8, (HEIGHT, WIDTH, 4)))
        self.assertGreater(full.std(), 0.1)

    def test_exr(self):
        openexr = reader("OpenEXR")
        for encoding, dtype in (("float", np.float32), ("half", np.float16)):
            with openexr.File(self.table(encoding + ".exr", encoding), separate_channels=True) as file:
                header, channels = file.header(), file.channels()
                for c, name in enumerate("RGB"):
                    pixels = channels[name].pixels
                    self.assertEqual(pixels.dtype, dtype)
                    self.assertTrue(np.array_equal(pixels, self.npy(encoding)[..., c]), (encoding, name))
                self.assertEqual(header["pellucid:form"], "sphere")
                self.assertEqual(header["pellucid:axis"], "root")
                self.assertAlmostEqual(header["pellucid:radiusMax"], 100)

    def test_batch(self):
        openexr = reader("OpenEXR")
        folder = Path(self.folder.name)
        (folder / "m.toml").write_text("version = 2\n[[lut]]\nsize = 13\nradius_min = 1\nradius_max = 100\n")
        subprocess.check_output([COMMAND, "batch", folder / "m.toml", "-o", folder / "out"])
        (path,) = (folder / "out").glob("*.exr")
        expected = np.load(self.table("square.npy", "half", "13x13"))
        with openexr.File(str(path), separate_channels=True) as file:
            self.assertEqual(len(file.header()["pellucid:checksum"]), 16)
            for c, name in enumerate("RGB"):
                self.assertTrue(np.array_equal(file.channels()[name].pixels, expected[..., c]))

    def test_8_bit(self):
        reader("PIL")
        from PIL import Image

        expected = self.npy("faceworks8")
        for kind in ("png", "bmp", "tga"):
            with Image.open(self.table("t." + kind, "faceworks8")) as image:
                pixels = np.asarray(image.convert("RGBA"))
            self.assertTrue(np.array_equal(pixels[..., :3], expected[..., :3]), kind)

    def test_ktx2(self):
        reader("pyktx2")
        from pyktx2 import parser

        # It walks the file by itself, but knows few colour models and texel formats, and pads after pos % 8.
        parser.BytesReader.get_padding_size = lambda self, alignment: -self.pos % alignment
        parser.ColorModel = int
        parser.get_stride = {97: 8}.__getitem__
        parser.VkFormat = int
        ktx = parser.parse_path(Path(self.table("half.ktx2", "half")))
        self.assertEqual((ktx.pixelWidth, ktx.pixelHeight), (WIDTH, HEIGHT))
        self.assertEqual((ktx.vkFormat, ktx.faceCount, ktx.levelCount), (97, 1, 1))
        facts, samples = ktx.dfd
        self.assertEqual((facts.colorModel, len(samples)), (1, 4))
        self.assertEqual(facts.transferFunction, parser.TransferFunction.KHR_DF_TRANSFER_LINEAR)
        self.assertEqual(ktx.kv["pellucid:axis"], b"root\0")
        (image,) = ktx.levelImages
        pixels = np.frombuffer(image.data, np.float16).reshape(HEIGHT, WIDTH, 4)
        self.assertTrue((pixels[..., 3] == 1).all())
        self.assertTrue(np.array_equal(pixels[..., :3], self.npy("half")))


result = unittest.main(verbosity=2, exit=False).result
for test, reason in result.skipped:
    print(f"tests/foreign::{test.id()} SKIPPED ({reason})")
sys.exit(1 if not result.wasSuccessful() else 77 if result.skipped else 0)
