"""How the tree is written: who includes whom, names in kernels, and what the pages say of files and commands.

test_tree.py [COMMAND]
"""
import functools
import json
import re
import subprocess
import sys
import unittest
from pathlib import Path

import jsonschema

ROOT = Path(__file__).resolve().parents[2]
COMMAND = ""
SOURCES = {".h", ".hpp", ".c", ".cpp", ".cl", ".clh"}

# Who may include whom (docs/dataflow.md, "Layers"): one way only. A folder's own files, the standard library
# and other people's headers are always allowed.
API, CL = "host/include/pellucid", "kernels/shared host/include/pellucid host/cl"
CORE = f"host/fields {CL} host/tuning host/core"
LAYERS = {
    "kernels/shared": "", "kernels/lib": "kernels/shared",
    **{f"kernels/{room}": "kernels/shared kernels/lib" for room in "mesh lut eye shading diffusion".split()},
    API: "", "host/system": "", "host/fields": API,
    "host/cl": f"kernels/shared {API} host/system",
    "host/tuning": f"{API} host/system",
    "host/core": f"host/fields {CL} host/tuning",
    "host/mesh": f"{CL} host/core host/system",
    "host/lut": f"{CORE} host/system",
    "host/eye": f"{CORE} host/lut",
    "host/shading": f"{CORE} host/lut host/eye",
    "host/diffusion": f"{CORE} host/mesh host/lut host/shading",
    "host/api": f"{CORE} host/mesh host/lut host/eye host/shading host/diffusion",
    "host/io": f"host/fields kernels/shared {API} host/system",
    "host/scene": f"host/fields {API} host/io",
    "host/profile_fit": f"{API} host/io",
    "host/sample": API,
    # The scenes of tests/diffusion.
    "bench/measure": f"{API} host/system host/tuning host/io host/sample tests/reference tests",
    # Applications: their commands are part of the command, which links them without including them.
    "apps/batch": f"{API} host/system host/io bindings/cli",
    "apps/demo": "host/io host/sample",
    "apps/gltf": f"{API} host/io host/sample bindings/cli",
    "apps/demo/tests": "host/sample apps/demo tests",
    "apps/batch/tests": f"{API} host/io apps/batch tests",
    "apps/gltf/tests": f"{API} host/io apps/gltf tests",
    "bindings/cli": f"host/fields {API} host/system host/tuning host/io host/scene host/profile_fit "
                    "host/sample bench/measure apps/demo",
    "bindings/python": f"host/fields {API} host/io host/scene apps/batch apps/demo apps/gltf",
    "examples": API,
    "bench": f"kernels/shared kernels/lib {API} host/io host/sample apps/demo bench/measure tests/reference "
             "tests",
    # host/cl and host/system: compiled programs and processes, which no call of the library shows.
    "tests": f"host/fields {CL} host/system host/tuning host/io host/scene host/profile_fit host/sample "
             "apps/batch apps/gltf apps/gltf/tests bench/measure tests/reference",
    "tests/reference": "",
}
BASES = [ROOT / base for base in "host kernels host/include apps tests bindings bench".split()]


def sources(*tops):
    return [p for top in tops for p in sorted((ROOT / top).rglob("*")) if p.suffix in SOURCES and p.is_file()]


def layer(path):
    """The longest entry of the table that is a folder above the file, or ""."""
    return next((str(p) for p in path.relative_to(ROOT).parents if str(p) in LAYERS), "")


def body(text, begin):
    """The text between the brace before `begin` and the one that closes it."""
    depth, end = 1, begin
    while depth and end < len(text):
        depth += (text[end] == "{") - (text[end] == "}")
        end += 1
    return text[begin:end]


@functools.cache
def kernels():
    """{file: its text without comments}"""
    return {p: "\n" + re.sub(r"//[^\n]*", "", p.read_text()) for p in sources("kernels")}


@functools.cache
def pages():
    names = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "bindings/python/README.md"]
    return {p: p.read_text() for p in [*map(ROOT.joinpath, names), *sorted((ROOT / "docs").rglob("*.md"))]}


def words(text):
    return [word.rstrip(",:;") for word in text.split() if word.rstrip(",:;")]


class Tree(unittest.TestCase):
    def none(self, wrong, checked, least):
        self.assertEqual(wrong, [], "\n" + "\n".join(wrong))
        self.assertGreater(checked, least)

    def test_every_include_goes_one_way(self):
        wrong, checked = [], 0
        for path in sources("kernels", "host", "apps", "bindings", "examples", "bench", "tests"):
            own = layer(path)
            included = re.findall(r'^\s*#\s*include\s*["<]([^">]+)[">]', path.read_text(), re.M)
            for name in included if own else ():
                found = next((b / name for b in [path.parent, *BASES] if (b / name).exists()), None)
                target = layer(found.resolve()) if found else ""
                if target not in ("", own):
                    checked += 1
                    if target not in LAYERS[own].split():
                        wrong.append(f"{path}: {own} must not include {target} ({name})")
        self.none(wrong, checked, 100)

    def test_sources_of_the_library_share_no_name_of_their_own(self):
        """A wheel compiles several of them at once (bindings/python/CMakeLists.txt)."""
        own = re.compile(r"^(?:static )?const(?:expr)? [\w:<>, *]*?\b(\w+)(?:\[[^\]]*\])*\s*[={;]"
                         r"|^(?:struct|class|enum(?: class)?) (\w+)(?: final)?\s*[:{]", re.M)
        places = {}
        for path in sources("host"):
            if path.suffix == ".cpp" and path.parts[len(ROOT.parts) + 1] not in ("io", "sample", "scene"):
                for found in own.finditer(path.read_text()):
                    places.setdefault(found[1] or found[2], set()).add(path.name)
        wrong = [f"{name}: {', '.join(sorted(at))}" for name, at in places.items() if len(at) > 1]
        self.none(wrong, len(places), 50)

    def test_one_system_alone_has_folders_of_its_own(self):
        """bench/measure and the native module of Python are for POSIX systems (docs/guide/install.md)."""
        system = re.compile(
            r"^\s*#\s*include\s*<((windows|io|process|unistd|fcntl|dlfcn|elf|pwd|poll)\.h|sys/[^>]*)>"
            r'|\b(v?fork|dlopen|dlsym|dladdr|LoadLibrary[AW]?)\(|"/proc/', re.M)
        using = [p for p in sources("host", "apps", "bindings/cli")
                 if p.suffix in (".h", ".cpp") and system.search(p.read_text())]
        self.none([str(p) for p in using if p.parent.name not in ("posix", "windows")], len(using), 5)

    def test_no_function_changes_a_structure_that_it_takes_by_value(self):
        """Mesa's rusticl 22.3 hands the caller's structure itself to such a function."""
        wrong, checked = [], 0
        for path, text in kernels().items():
            for function in re.finditer(r"\b(\w+)\s*\(([^(){};]*)\)\s*\{", text):
                code = body(text, function.end())
                for name in re.findall(r"(?:^|,)\s*(?:const\s+)?[A-Z]\w*\s+(\w+)\s*(?=,|$)", function[2]):
                    checked += 1
                    if re.search(rf"(^|[^\w.>]){name}(\.\w+)*\s*([-+*/|&^]|<<|>>)?=(?!=)|(\+\+|--){name}\b"
                                 rf"|\b{name}(\.\w+)*(\+\+|--)|[(,]\s*&{name}\b", code):
                        wrong.append(f"{path}: {function[1]} changes {name}; let it work on a copy")
        self.none(wrong, checked, 100)

    def test_names_in_kernels(self):
        """CONTRIBUTING.md, "Names"."""
        wrong, checked = [], 0
        for path, text in kernels().items():
            shared = path.relative_to(ROOT / "kernels").parts[0] in ("lib", "shared")
            for what, rule, form in (
                (r"__kernel[^{;]*?void\s+(\w+)\s*\(", r"[a-z0-9]+(_[a-z0-9]+)*", "snake_case"),
                (r"\n(?:static )?inline [\w ]+\*?\s(\w+)\(", r"(as_|convert_)?[a-z][a-zA-Z0-9]*",
                 "lowerCamelCase"),
                (r"\n\s*#\s*define\s+(\w+)", r"PEL_[A-Z0-9_]+|[a-z]+w|(as|convert)_[a-z]+w" if shared else
                 r"[A-Z][A-Z0-9_]*(_[a-z][a-zA-Z0-9]*)?|kernel",
                 "PEL_UPPER_CASE" if shared else "UPPER_CASE"),
            ):
                for name in re.findall(what, text):
                    checked += 1
                    if not re.fullmatch(rule, name):
                        wrong.append(f"{path}: {name} should be {form}")
        self.none(wrong, checked, 500)

    def test_readme_quotes_the_minimal_example(self):
        example = (ROOT / "examples/example_minimal.c").read_text()
        self.assertIn(f"```c\n{example}```", pages()[ROOT / "README.md"])

    def test_links_lead_somewhere(self):
        links = [(page, link) for page, text in pages().items()
                 for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text)]
        wrong = [f"{page} links to {link}" for page, link in links if not (page.parent / link).exists()]
        self.none(wrong, len(links), 50)

    def test_calls_say_whether_they_wait(self):
        header = (ROOT / API / "pellucid.h").read_text(encoding="utf-8")
        calls = re.findall(r"PEL_API [^;(]*?\b(pel[A-Z]\w*)\(", header)
        page = (ROOT / "docs/guide/hosts.md").read_text(encoding="utf-8")
        table = page[page.index("## What a call may do"):page.index("## Memory")]
        together = re.compile(r"pel(Profile|Skin)|.*(Retain|Release)$")
        missing = [c for c in calls if not together.match(c) and f"`{c}`" not in table]
        self.assertGreater(len(calls), 110)
        self.assertEqual(missing, [], "docs/guide/hosts.md, \"What a call may do\"")

    def test_named_files_exist(self):
        """In code spans: paths whose first folder is one of the tree's, and sources by their name alone.
        `x.*` stands for any ending."""
        folders = {"apps", "bench", "bindings", "cmake", "docs", "examples", "host", "kernels", "tests"}
        files = [p for folder in folders for p in (ROOT / folder).rglob("*")]
        there = "".join(f"{p}\n{p.with_suffix('')}.*\n" for p in files)
        objects = {"device.cl", "buffer.cl", "event.cl"}  # attributes of Python objects
        wrong, named = [], 0
        for page, text in pages().items():
            if page.name == "CHANGELOG.md":  # history may name files that are gone
                continue
            prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
            for word in words(" ".join(re.findall(r"`([^`\n]+)`", prose))):
                path = word.split("/")[0] in folders and re.fullmatch(r"[\w.-]+/[\w./-]*(\.\*)?", word)
                source = re.fullmatch(r"[\w/-]+\.(cpp|c|h|hpp|cl|clh|py|md)", word)
                if path or (source and word not in objects):
                    named += 1
                    if not (ROOT / word).exists() and f"/{word}\n" not in there:
                        wrong.append(f"{page} names {word}")
        self.none(wrong, named, 100)

    def test_figures_are_shown_and_small(self):
        figures = list((ROOT / "docs/figures").iterdir())
        wrong = [str(f) for f in figures if f.stat().st_size > 300 << 10 or
                 not any(f"figures/{f.name}" in text for text in pages().values())]
        self.none(wrong, len(figures), 0)

    def test_commands_and_options_of_the_pages_exist(self):
        """"pellucid ..." at the start of an indented line, in a block of code, or in a code span."""
        if not COMMAND:
            self.skipTest("no command is given")
        known = {}  # options of each subcommand

        def walk(command, app):
            known[command] = {name for option in app["options"] for name in option["names"]}
            for sub in app["subcommands"]:
                for name in [sub["name"], *sub.get("aliases", ())]:
                    walk(f"{command}{name} ", sub)

        walk("", json.loads(subprocess.check_output([COMMAND, "describe"], text=True)))
        shown = re.compile(r"^(?:    )?pellucid ([^\n#;]*)|`pellucid ([^`]*)`", re.M)
        commands = [(page, line or span) for page, text in pages().items()
                    for line, span in shown.findall(text)]
        wrong, options = [], 0
        for page, command in commands:
            meant = [""]  # `lut curvature|shadow` means two
            for i, word in enumerate(words(re.sub(r"[\[\]]", " ", command))):
                deeper = [f"{m}{choice} " for m in meant[:len(meant) == 1] for choice in word.split("|")
                          if f"{m}{choice} " in known]
                if i == 0 and word[0].islower() and not deeper:
                    wrong.append(f"{page}: pellucid {command}: no {word}")
                meant = deeper or meant
                if re.match("--?[a-z]", word):  # in one subcommand that may be meant; `lut` means all kinds
                    options += 1
                    option = re.split(r"[|=]", word)[0]
                    if not any(option in names and (name == m or m == "lut " and name.startswith(m))
                               for name, names in known.items() for m in meant):
                        wrong.append(f"{page}: pellucid {command}: no option {word}")
        self.none(wrong, min(options, len(commands)), 30)

    def test_reports_of_the_benchmark_are_as_their_schema_says(self):
        schema = jsonschema.Draft202012Validator(json.loads((ROOT / "docs/bench.schema.json").read_text()))
        reports = sorted((ROOT / "bench/results").glob("*.json"))
        wrong = [f"{report.name}: {error.json_path}: {error.message[:300]}" for report in reports
                 for error in schema.iter_errors(json.loads(report.read_text()))]
        self.none(wrong[:20], len(reports), 3)


if __name__ == "__main__":
    COMMAND = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    unittest.main()
