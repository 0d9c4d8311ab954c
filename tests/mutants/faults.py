"""Small faults in C++, OpenCL C and Python text: one for each line with code, the same ones for the same
text.

A fault is found in the text with comments, strings, preprocessor lines and messages blanked out, so that
each one changes what runs.
"""
import hashlib
import io
import re
import sys
import tokenize
from dataclasses import dataclass

import meanings
from meanings import closing

COMPARISON = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}


def both_ways(pairs):
    """{word: its other}, of "a/b c/d"."""
    split = [pair.split("/") for pair in pairs.split()]
    return {**{b: a for a, b in split}, **{a: b for a, b in split}}


OPERATOR = {"*": "/", "/": "*", "%": "/", "*=": "/=", "/=": "*=",
            **both_ways("+/- &/| <</>> +=/-= |=/&= &&/|| and/or")}
WORD = both_ways("true/false True/False min/max fmin/fmax minw/maxw floor/ceil sin/cos any/all front/back "
                 "any_of/all_of continue/break")
MESSAGE = r"\b(?:fail|invalidArgument|badFile|warn|note|printf|fprintf|print|throw [\w:]+|raise [\w.]+)\("


@dataclass(frozen=True)
class Fault:
    path: str
    start: int
    end: int
    new: str
    kind: str
    line: int
    name: str  # from the lines around it, so that it is found again after edits elsewhere

    def apply(self, text):
        return text[:self.start] + self.new + text[self.end:]


def blank(text):
    return re.sub(r"[^\n]", " ", text)


def masked_c(text):
    pattern = re.compile(
        r'//[^\n]*|/\*.*?\*/|R"\w*\(.*?\)\w*"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\''
        r"|^[ \t]*#(?:\\\n|[^\n])*",
        re.S | re.M)

    def keep(match):
        found = match[0]
        # A quote between digits is no literal.
        if found[0] == "'" and match.start() and text[match.start() - 1].isdigit():
            return found
        return '"' + blank(found[1:-1]) + '"' if found[0] in "\"'" else blank(found)

    return pattern.sub(keep, text)


def masked_python(text):
    lines = text.splitlines(keepends=True)
    offsets = [0]
    for line in lines:
        offsets.append(offsets[-1] + len(line))
    out = list(text)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in (tokenize.COMMENT, tokenize.STRING):
            begin, end = (offsets[row - 1] + column for row, column in (token.start, token.end))
            for i in range(begin, end):
                if out[i] != "\n":
                    out[i] = " "
            if token.type == tokenize.STRING:
                out[begin] = out[end - 1] = '"'
    return "".join(out)


def masked(path, text):
    out = masked_python(text) if path.endswith(".py") else masked_c(text)
    for match in re.finditer(MESSAGE, out):
        end = closing(out, match.end() - 1)
        if end > 0:
            out = out[:match.end()] + blank(out[match.end():end]) + out[end:]
    return out


def operand(text, at):
    """The end of the operand that begins at `at`: signs and casts, a name, number or bracket, and what
    follows it without a space."""
    at = re.compile(r"[-+!~*&]*").match(text, at).end()
    start = at
    while at < len(text):
        if text[at] in "([":
            at = closing(text, at) + 1
            if at == 0:
                return start
            continue
        match = re.compile(r"(?:->|\.)?\w[\w.]*(?:::\w+)*(?:<[\w:*, ]+>(?=\())?").match(text, at)
        if not match:
            break
        at = match.end()
    return at


def number(text):
    """Another constant than `text`, or nothing."""
    digits, suffix = re.fullmatch(r"(0[xX][0-9a-fA-F]+|[\d.]+(?:[eE][-+]?\d+)?)(\w*)", text).groups()
    if digits[:2] in ("0x", "0X"):
        return f"{hex(int(digits, 16) ^ 1)}{suffix}"
    if digits.isdigit():
        value = int(digits)
        return f"{value + 1 if value != 1 else 2}{suffix}"
    value = float(digits)
    if 0 < abs(value) < 1e-15:
        return None  # a guard against 0, whatever its size
    changed = 1.0 if value == 0 else value * (1.1 if 1e-3 <= value <= 1e4 else 100.0)
    return f"{changed!r}{suffix}"


def term_end(m, at, sign):
    """Where the operand at `at` ends; after + and - with its factors."""
    end = operand(m, at)
    while sign in "+-" and end > at and (more := re.compile(r" [*/%] ").match(m, end)):
        end = operand(m, more.end())
    return end


def candidates(path, text, m):
    """(start, end, new, kind) of every fault."""
    python = path.endswith(".py")
    for match in re.finditer(r"(?<![\w.'])(?:0[xX][0-9a-fA-F]+|(?:\d+\.\d*|\d+)(?:[eE][-+]?\d+)?|\.\d+)"
                             r"[fFuUlL]*(?![\w.'])", m):
        if changed := number(match[0]):
            yield *match.span(), changed, "constant"
    for match in re.finditer(r" (<=|>=|==|!=|<|>)(?= )", m):
        line = m[m.rfind("\n", 0, match.start()) + 1:match.start()]
        # A loop ends one too early: one too late would be undefined, and often unseen.
        early = match[1] == "<" and re.search(r"\bfor \([^;]*;[^;]*$", line)
        yield *match.span(1), "+ 1 <" if early else COMPARISON[match[1]], "comparison"
    for match in re.finditer(r" (\+=|-=|\*=|/=|\|=|&=|&&|\|\||and|or|%|&|\||<<|>>)(?=\s)", m):
        line = m[m.rfind("\n", 0, match.start()) + 1:m.find("\n", match.end())]
        if match[1] not in ("<<", ">>") or not (line.count(match[1]) > 1 or '"' in line):
            yield *match.span(1), OPERATOR[match[1]], "operator"
    for match in re.finditer(r"(?<=[\w)\]]) ([-+*/]) (?=[^\s\"])", m):
        # Texts are joined with + as well, and know no other operator.
        if match[1] == "+" and '"' in m[m.rfind("\n", 0, match.start()) + 1:m.find("\n", match.end())]:
            continue
        end = term_end(m, match.end(), match[1])
        yield *match.span(1), OPERATOR[match[1]], "operator"
        if end > match.end():
            yield match.start(), end, "", "dropped term"
        left = re.search(r"(?<![\w.>\])])[\w.]+$", m[max(0, match.start() - 40):match.start()])
        right = re.compile(r"[\w.]+(?![\w.(\[]|->)").match(m, match.end())
        if match[1] in "-/" and left and right:
            begin = match.start() - len(left[0])
            yield begin, right.end(), f"{right[0]} {match[1]} {left[0]}", "swapped operands"
    for match in re.finditer(r"(?<![\w.])(\w+)(?=\()|\b(true|false|True|False|continue|break)\b", m):
        if match[0] in WORD:
            yield *match.span(), WORD[match[0]], "other word"
    for match in re.finditer(r"(?<=[\w\])]\.)[xyz]\b(?!\()", m):
        yield *match.span(), "xyz"["xyz".index(match[0]) - 2], "other component"
    for match in re.finditer(r"(?<![\w.])[\w.:]+\(([\w.\[\]]+), ([\w.\[\]]+)\)", m):
        if match[1] != match[2]:
            yield match.start(1), match.end(2), f"{match[2]}, {match[1]}", "swapped arguments"
    for match in re.finditer(r"\? ([\w.\"]+) : ([\w.\"]+)(?=[;,)\s])", m):
        one, other = text[slice(*match.span(1))], text[slice(*match.span(2))]
        yield match.start(1), match.end(2), f"{other} : {one}", "swapped arguments"
    if python:
        for match in re.finditer(r"\bnot (?=\w|\()", m):
            yield *match.span(), "", "dropped negation"
        for match in re.finditer(r"\bif ([^\n:]+):\s", m):
            yield *match.span(1), "False", "removed check"
        for match in re.finditer(r"^ +((?!return|raise|yield|pass|import|from|assert|def|class|del|if|for|while"
                                 r"|with|else)[\w.]+(?:\([^\n]*\)| [-+*|&/]?= [^\n(]+))$", m, re.M):
            if '("' not in match[1][:3] and match[1].count("(") == match[1].count(")"):
                yield *match.span(1), "pass", "dropped statement"
        return
    for match in re.finditer(r"(?<![\w)\]=!<>])!(?=[\w(:])", m):
        yield *match.span(), "", "dropped negation"
    for match in re.finditer(r"\bif \(", m):
        end = closing(m, match.end() - 1)
        if end > 0 and ";" not in m[match.start():end]:
            yield match.end(), end, "false", "removed check"
            yield match.end(), end, "true", "forced branch"
    for match in re.finditer(r"^ +(?!return|throw|if|for|while|else|case|using|static|const|delete|break"
                             r"|continue|fail|invalidArgument)"
                             r"([A-Za-z_][\w.:>\[\]-]*(?:\([^\n]*\)| [-+*|&/]?= [^\n]+);)$", m, re.M):
        if match[1].count("(") == match[1].count(")"):
            yield *match.span(1), ";", "dropped statement"
    for match in re.finditer(r"\b(?:cl::)?check\(", m):
        end = closing(m, match.end() - 1)
        if end > 0 and (comma := m.rfind(",", match.end(), end)) > 0:
            yield match.start(), end + 1, f"(void)({text[match.end():comma]})", "unchecked return"


NOTHING_CHANGES = re.compile(r"\breserve\(|static_assert|\btemplate\b|__attribute__|PEL_API|\boperator\b"
                             r"|^\s*(?:from|import)\b|\bassert\b|#pragma|noexcept")


def faults(path, text, meaning=False):
    """One fault for each line of `text` that has any; with `meaning` of meanings.py."""
    m = masked(path, text)
    lines, shown = text.split("\n"), {}
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    by_line = {}
    row = 0
    for found in sorted(set((meanings if meaning else sys.modules[__name__]).candidates(path, text, m))):
        while starts[row + 1] <= found[0]:
            row += 1
        if not NOTHING_CHANGES.search(lines[row]) and text[found[0]:found[1]] != found[2]:
            by_line.setdefault(row, []).append(found)
    for row, several in by_line.items():
        around = "\n".join(line.strip() for line in lines[max(0, row - 1):row + 2])
        shown[around] = shown.get(around, 0) + 1

        def digest(found):
            what = [path.rpartition("/")[2], around, shown[around], found[0] - starts[row],
                    text[found[0]:found[1]], found[2]]
            return hashlib.sha256("\n".join(map(str, what)).encode()).hexdigest()[:12]

        # Kinds first, for a line may have many constants and one comparison. Nearly every line could be
        # dropped as a whole.
        kinds = {f[3] for f in several if f[3] != "dropped statement"} or {"dropped statement"}
        first = min(kinds, key=lambda kind: hashlib.sha256((around + kind).encode()).digest())
        start, end, new, kind = min((f for f in several if f[3] == first), key=digest)
        yield Fault(path, start, end, new, kind, row + 1, digest((start, end, new, kind)))
