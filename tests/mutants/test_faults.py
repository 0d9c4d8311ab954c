"""The faults that ./run check mutants makes: of each kind, in code alone, the same ones each time."""
import unittest
from pathlib import Path

import faults

ROOT = Path(__file__).resolve().parents[2]
CODE = """// a comment: 1 + 2 < 3
#define LEFT_ALONE 0.5f
float mean(const float* v, int n) {
    if (n <= 0) fail("not 1 + 2 but 3", n + 1);
    float sum = 0.5f;
    for (int i = 0; i < n; ++i) sum += v[i] * scale(n, v);
    const bool odd = !even(n) && n > 3;
    cl::check(launch(n), "launch");
    total.add(sum);
    return std::max(sum - n, odd ? a : b) / 3.0f;
}
"""


class Faults(unittest.TestCase):
    def every(self, path, text, wanted, candidates=faults.candidates):
        """The text with each of its faults, among which are those that hold `wanted`."""
        made = [text[:start] + new + text[end:]
                for start, end, new, _ in candidates(path, text, faults.masked(path, text))]
        self.assertEqual([w for w in wanted if not any(w in text for text in made)], [])
        return made

    def test_every_kind(self):
        made = self.every("a.cpp", CODE, (
            "if (n < 0) fail", "if (false) fail", "if (true) fail", "sum = 0.55f;", "i + 1 < n;",
            "sum -= v[i]", "v[i] / scale", "+= v[i];", "scale(v, n)", "= even(n)", "|| n > 3", "&& n >= 3",
            "(void)(launch(n));", "    ;\n    return", "std::min(", "max(n - sum,", "max(sum + n,",
            "max(sum,", "odd ? b : a", "* 3.0f;"))
        for text in made:
            self.assertNotEqual(text, CODE)
            for kept in ("// a comment: 1 + 2 < 3\n#define LEFT_ALONE 0.5f\n", '"launch"'):
                self.assertTrue(kept in text or "(void)(launch" in text or "    ;\n" in text, text)
            if "fail(" in text:
                self.assertIn('fail("not 1 + 2 but 3", n + 1)', text)

    def test_every_kind_of_meaning(self):
        code = """void Sums::prepare() {
    if (empty_) return;
    device_->fill(sums_.get(), 0,
                  bytes, 0);
    sums_ = device_->allocateZeros(bytes);
    if (bytes != bytes_ || !std::equal(now.begin(), now.end(), sent_.begin()))
        key.addPart(name).addPart(options);
    keys = {{"PEL_A", text(1)}, {"PEL_B", f(x, 2)}};
    for (int j = -1; j <= 1; ++j) low = min(size[0], min(left, at[x + 1]));
}
"""
        self.every("a.cpp", code, (
            "if (false) return;", "    ;\n    sums_", "device_->allocate(bytes)", "if (bytes != bytes_)\n",
            "if (!std::equal(", "key.addPart(options);", "key.addPart(name);", '{{"PEL_A", text(1)}};',
            '{ {"PEL_B", f(x, 2)}};', "int j = 0; j <= 1", "j <= 0;", "low = size[0];",
            "low = min(left, at[x + 1]);", "min(size[0], left)", "min(size[0], at[x + 1])", "at[x]"),
            faults.meanings)

    def test_python(self):
        code = ('def f(a, b):\n    """1 + 2"""\n    if not a:  # 3 < 4\n        raise ValueError("5 + 6")\n'
                '    g(a, b)\n    return a and b is None\n')
        for text in self.every("a.py", code, ("if a:", "if False:", "    pass\n", "g(b, a)", "a or b")):
            compile(text, "a.py", "exec")
            self.assertTrue(all(kept in text for kept in ('"""1 + 2"""', "# 3 < 4", '"5 + 6"')), text)

    def test_one_for_each_line_and_the_same_ones_after_edits_elsewhere(self):
        first = list(faults.faults("a.cpp", CODE))
        self.assertEqual(len({f.line for f in first}), len(first))
        self.assertEqual(len(first), 7)
        moved = list(faults.faults("b/a.cpp", "int other() {\n    return 1;\n}\n\n" + CODE))
        self.assertEqual([f.name for f in first][1:], [f.name for f in moved][-len(first) + 1:])

    def test_the_tree(self):
        count = names = 0
        for folder in ("kernels/**/*.cl*", "host/**/*.cpp", "bindings/python/pellucid/*.py", "apps/*/*/*.py"):
            for path in ROOT.glob(folder):
                text = path.read_text()
                found, larger = (list(faults.faults(str(path.relative_to(ROOT)), text, meaning))
                                 for meaning in (False, True))
                count, names = count + len(found), names + len({f.name for f in found})
                for fault in found + larger:
                    self.assertNotEqual(fault.apply(text), text)
        self.assertGreater(count, 3000)
        self.assertGreater(names, 0.995 * count)


if __name__ == "__main__":
    unittest.main()
