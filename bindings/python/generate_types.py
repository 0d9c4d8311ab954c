"""Generates the binding's types from pellucid.h, so that structures and comments exist only there.

    generate_types.py HEADER OUT_PY OUT_INC

OUT_PY: the enumerations and plain structures as Python classes with the header's own documentation.
OUT_INC: for the native module, the defaults and field offsets of the same structures as the compiler sees
them. Structures that hold pointers or handles are left out: the native module has functions for those. A
handle in HANDLES is an attribute that takes the Python object, or its name.
"""
import os
import re
import sys
import textwrap
from pathlib import Path

import field_rows

SCALARS = {
    "uint32_t": ("np.uint32", "int"), "uint64_t": ("np.uint64", "int"), "int32_t": ("np.int32", "int"),
    "int": ("np.intc", "int"), "float": ("np.float32", "float"), "double": ("np.float64", "float"),
}
HANDLES = {"PelProfile": "Profile"}


def tidy(comment):
    """The text of a C comment as one paragraph."""
    return " ".join(re.sub(r"^\s*\*", "", line).strip() for line in comment.strip().splitlines()).strip()


def snake(name):
    return re.sub(r"(?<=[a-z0-9])([A-Z])", lambda m: "_" + m.group(1).lower(), name)


def comment_before(text, position):
    """The comment that ends right before `position`, or ""."""
    match = re.search(r"/\*((?:(?!\*/).)*)\*/\s*\Z", text[:position], re.S)
    return tidy(match.group(1)) if match and not match.group(1).startswith(" ----") else ""


def comments_behind(body):
    """The body of a structure or enumeration, with each comment above a member moved behind the member."""
    comment, member = r"^[ ]*/\*((?:(?!\*/).)*)\*/[ ]*\n", r"([ ]*\w[^;,/\n]*(?:[;,]|(?=\n)))[ ]*$"
    return re.sub(comment + member, r"\2 /*\1*/", body, flags=re.S | re.M)


def parse_enums(text):
    enums = {}
    for match in re.finditer(r"typedef enum (\w+) \{(.*?)\} \1;", text, re.S):
        entries = re.findall(r"(PEL_\w+) =\s*([^,/\n]+?)\s*,?[ ]*(?:/\*(.*?)\*/)?\s*(?=\n|PEL_|\Z)",
                             comments_behind(match.group(2)), re.S)
        names = [name for name, _, _ in entries]
        if not entries or len(names) != len(re.findall(r"PEL_\w+ =", match.group(2))):
            raise SystemExit(f"{match.group(1)}: an enumerator was not understood")
        parts = [name.split("_") for name in names]
        shared = os.path.commonprefix(parts)
        common = 2 if len(parts) == 1 else min(len(shared), min(map(len, parts)) - 1)
        members = [("_".join(p[common:]).removeprefix("ERROR_"), value, tidy(doc), name)
                   for p, (name, value, doc) in zip(parts, entries) if p[-1] != "COUNT"]
        enums[match.group(1)] = (comment_before(text, match.start()), members)
    return enums


def parse_structs(text, enums):
    structs = {}
    for match in re.finditer(r"typedef struct (\w+) \{(.*?)\} \1;", text, re.S):
        name, body = match.groups()
        if not body.strip().startswith("uint32_t structSize"):
            continue
        fields = []
        body = re.sub(r"^\s*/\*.*?\*/\s*$", "", comments_behind(body), flags=re.S | re.M)
        for declaration, doc in re.findall(r"([\w][\w \*\[\],]*);[ ]*(?:/\*(.*?)\*/)?", body, re.S):
            pointer = re.match(r"(?:const )?(\w+)\s*(\*?)\s*(\w+)((?:\[\w+\])*)$", declaration.strip())
            if not pointer:
                raise SystemExit(f"{name}: the field '{declaration}' was not understood")
            kind, star, field, dimensions = pointer.groups()
            fields.append((field, kind + star, [int(d) for d in re.findall(r"\[(\d+)\]", dimensions)],
                           tidy(doc)))
        known = all(kind in SCALARS or kind in enums or kind in structs or kind == "char" or kind in HANDLES
                    for _, kind, _, _ in fields)
        if known:
            structs[name] = (comment_before(text, match.start()), fields)
    return structs


def python_name(name):
    return "ErrorCode" if name == "PelError" else name[3:]


def translator(enums, structs):
    """A function that rewrites the C names inside a comment into the Python ones."""
    words = {full: f"{python_name(name)}.{short}"
             for name, (_, members) in enums.items() for short, _, _, full in members}
    words |= {field: snake(field) for _, fields in structs.values() for field, _, _, _ in fields}

    def word(match):
        w = match[0]
        if w in words and (w.isupper() or w != w.lower()):
            return words[w]
        return w[3:] if re.match(r"Pel[A-Z]", w) else w

    return lambda text: re.sub(r"\b\w+\b", word, text).replace("\\", "\\\\").replace('"""', "'''")


def wrapped(text, indent, width=110):
    return "\n".join(textwrap.wrap(text, width - len(indent), initial_indent=indent,
                                   subsequent_indent=indent))


def python_field(field, kind, shape, enums, structs):
    """dtype entry, descriptor, type of the argument that sets it ("": none), and the documentation's type."""
    p = snake(field)
    if kind == "char":
        return f'("{p}", "S{shape[0]}")', f'Field[str]("{p}")', "", "str"
    if kind in HANDLES:
        h = HANDLES[kind]
        return f'("{p}", np.uintp)', f'{h}Field("{p}")', f"{h} | str", f"{h} or its name in the library"
    if kind in enums:
        e = kind[3:]
        return f'("{p}", np.int32)', f'Field("{p}", {e})', f"{e} | str", f"{e} or its name"
    if kind in structs:
        s = kind[3:]
        return f'("{p}", {s}._dtype)', f'Field("{p}", {s})', s, s
    dtype, number = SCALARS[kind]
    if shape:
        size = " x ".join(map(str, shape))
        entry = f'("{p}", {dtype}, {tuple(shape)})'
        return entry, f'Field[NDArray[Any]]("{p}")', "ArrayLike", f"array of {size} {dtype[3:]}"
    return f'("{p}", {dtype})', f'Field[{number}]("{p}")', number, number


def python_struct(name, doc, fields, enums, structs, say):
    python = name[3:]
    lines, dtypes, arguments, settings, docs = [], [], [], [], []
    for field, kind, shape, comment in fields:
        p = snake(field)
        dtype, descriptor, argument, hint = python_field(field, kind, shape, enums, structs)
        dtypes.append(dtype)
        if field == "structSize":
            continue
        lines.append(f"    {p} = {descriptor}")
        docs.append(f"    {p} : {hint}" + (f"\n{wrapped(say(comment), '        ')}" if comment else ""))
        if argument:
            arguments.append(f"{p}: {argument} | None = None")
            settings.append(f"{p}={p}")
    summary = wrapped('"""' + (say(doc) or f"{python} values."), "    ")
    return "\n".join([
        f"\nclass {python}(Struct):", summary, "\n    Attributes\n    ----------", *docs, '    """\n',
        f'    _c_name = "{name}"', "    _dtype = np.dtype([" + ", ".join(dtypes) + "], align=True)", *lines,
        "\n    def __init__(self, *, " + ",\n                 ".join(arguments) + ") -> None:",
        "        super().__init__(" + ",\n                         ".join(settings) + ")\n"])


def python_module(enums, structs):
    say = translator(enums, structs)
    out = ['"""Enumerations and plain structures of pellucid.h. Written by generate_types.py: do not '
           'edit."""',
           "from __future__ import annotations\n", "from dataclasses import dataclass\n",
           "import numpy as np",
           "from numpy.typing import ArrayLike, NDArray\n",
           "from ._struct import Enumeration, Field, Flags, ProfileField, Struct",
           "from typing import TYPE_CHECKING, Any\n", "if TYPE_CHECKING:\n    from .profile import Profile\n"]
    exported = []
    for name, (doc, members) in enums.items():
        python = python_name(name)
        exported.append(python)
        base = "Flags" if any("<<" in value for _, value, _, _ in members) else "Enumeration"
        out.append(f"\nclass {python}({base}):")
        out.append(f'    """{say(doc) or python + " values."}"""\n')
        for short, value, comment, _ in members:
            out.append(f"    {short} = {value}")
            if comment:
                out.append(f'    """{say(comment)}"""')
        out.append("")
    for name, (doc, fields) in structs.items():
        exported.append(name[3:])
        out.append(python_struct(name, doc, fields, enums, structs, say))
    out.append("\n__all__ = [" + ",\n           ".join(f'"{e}"' for e in exported) + "]")
    return "\n".join(out) + "\n"


def sliders(rows):
    """The sliders of fields that have one, by the name of their key in files."""
    found = {row.key: row.slider for list_of_rows in rows.values() for row in list_of_rows if row.slider}
    entries = "".join(f'    "{key}": {slider!r},\n' for key, slider in found.items())
    material = "".join(f"    {row.key}: float = {row.default}\n" for row in rows["MATERIAL"] if row.slider)
    return (f"\nSLIDERS: dict[str, tuple[str, float, float, float]] = {{\n{entries}}}\n"
            '"""Label, minimum, maximum and step of the viewer\'s slider for a field."""\n'
            '\n\n@dataclass\nclass MaterialValues:\n    """The fields of Material that have a slider."""\n\n'
            f"{material}")


def native_table(structs):
    out = ["// Written by generate_types.py: do not edit.", "static const StructInfo structInfos[] = {"]
    for name, (_, fields) in structs.items():
        offsets = ", ".join(f'{{"{snake(field)}", offsetof({name}, {field})}}' for field, _, _, _ in fields)
        default = name[0].lower() + name[1:] + "Defaults"
        out.append(f'    {{"{name}", sizeof({name}), [](void* to) {{ const {name} s = {default}(); '
                   f'std::memcpy(to, &s, sizeof s); }}, {{{offsets}}}}},')
    return "\n".join(out + ["};"]) + "\n"


def main(header, out_py, out_inc):
    text = Path(header).read_text(encoding="utf-8")
    enums = parse_enums(text)
    structs = parse_structs(text, enums)
    if len(enums) < 8 or "PelMaterial" not in structs:
        raise SystemExit(f"{header}: {len(enums)} enumerations and {len(structs)} structures understood: "
                         "too few, this program is broken")
    rows = field_rows.parse(Path(header).with_name("pellucid_fields.h"))
    Path(out_py).write_text(python_module(enums, structs) + sliders(rows), encoding="utf-8")
    Path(out_inc).write_text(native_table(structs), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
