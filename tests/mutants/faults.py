"""Small faults in C++, OpenCL C and Python text: one for each line with code, the same ones for the same
text.

A fault is found in the text with comments, strings, preprocessor lines and messages blanked out, so that
each one changes what runs.
"""
import hashlib
import re
from dataclasses import dataclass

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
# Declarations of arrays, whose lengths are no faults: one more changes nothing.
ARRAY = (r"^ *(?!return|case)(?:[\w:<>]+[*&]? )+\w+(?:\[\w+\])+(?:, \w+(?:\[\w+\])+)*"
         r"|^ *(?:const )?std::array<.*?, \d+> \w+(?=[;{]| =)")
# Guards around code that has no effect if no lane takes part: they save time.
SAVES_TIME = r"(?:!SKIPPING \|\| )?anyw\("
ENDS_EARLY = r"(?:SKIPPING && )?!anyw\("
# With one lane, loadw(i, p) is p[i], which is i[p]; with more the other order does not compile.
COMMUTATIVE = re.compile(r"\b(?:f?(?:min|max)w?|add3|dot3?|hypot|gcd|loadw|sameShape|distance)$")
# A number of elements, and the character after it.
COUNT = re.compile(r"\bfor \([^;]*;[^;]*< \w+;$|\b(?:copy|fill)_n\(.*, \w+,$|\bmem(?:cpy|cmp)\(.*, \w+\)$")
TIME_ALONE = r"\b(?:PEL_PREFETCH|reserve)\("
# Comments, the texts of literals (not a quote between digits), and preprocessor lines.
HIDDEN_C = re.compile(r'//[^\n]*|/\*.*?\*/|R"\w*\(.*?\)\w*"|(?P<text>"(?:\\.|[^"\\\n])*"'
                      r"|(?<!\d)'(?:\\.|[^'\\\n])+')|^[ \t]*#(?:\\\n|[^\n])*", re.S | re.M)
HIDDEN_PYTHON = re.compile(r"""#[^\n]*|(?P<text>(?<!\w)[a-zA-Z]{0,2}(?P<q>\"\"\"|'''|"|')"""
                           r"(?:\\.|(?!(?P=q)).)*(?P=q))", re.S)


@dataclass(frozen=True)
class Fault:
    path: str
    start: int
    end: int
    new: str
    kind: str
    line: int
    name: str  # from the surrounding lines, so that it is found again after edits elsewhere

    def apply(self, text):
        return text[:self.start] + self.new + text[self.end:]

    def is_python(self):
        """Whether tests in Python notice it."""
        return self.path.startswith("bindings/python") or self.path.endswith(".py")


def lanes(text, line):
    """The number of lanes that this line of a kernel is for alone, or None."""
    around = []
    for row in text.split("\n")[:line]:
        if found := re.match(r"# *(if|elif|else|endif)\w*(.*)", row):
            word, condition = found.groups()
            before = around.pop() if word != "if" else ""
            if word != "endif":
                around.append("PEL_WIDTH == 1" if word == "else" and "PEL_WIDTH > 1" in before else condition)
    return next((found[1] for each in around if (found := re.search(r"PEL_WIDTH == (\d+)", each))), None)


def closing(text, opening):
    """The index of the bracket that closes the one at `opening`, or -1."""
    depth = 0
    for i in range(opening, len(text)):
        depth += (text[i] in "([{") - (text[i] in ")]}")
        if depth == 0:
            return i
    return -1


def masked(path, text):
    def blank(hidden):
        return re.sub(r"[^\n]", " ", hidden)

    def keep(match):
        return '"' + blank(match[0][1:-1]) + '"' if match["text"] else blank(match[0])

    out = (HIDDEN_PYTHON if path.endswith(".py") else HIDDEN_C).sub(keep, text)
    for match in re.finditer(f"{MESSAGE}|{TIME_ALONE}", out):
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


def number(match):
    """Another constant, or nothing. Loops and copies end one too early: one too late would be undefined, and
    often unseen."""
    digits, suffix = re.fullmatch(r"(0[xX][0-9a-fA-F]+|[\d.]+(?:[eE][-+]?\d+)?)(\w*)", match[0]).groups()
    if digits[:2] in ("0x", "0X"):
        return f"{hex(int(digits, 16) ^ 1)}{suffix}"
    if digits.isdigit():
        line = match.string[match.string.rfind("\n", 0, match.start()) + 1:match.end() + 1]
        return f"{int(digits) + (-1 if int(digits) > 1 and COUNT.search(line) else 1)}{suffix}"
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


def each(m, kind, pattern, new):
    """A fault for each match: `new`, or what it returns, in place of group 1, or of all without one."""
    for match in re.finditer(pattern, m, re.M):
        changed = new(match) if callable(new) else new
        if changed is not None:
            yield *match.span(match.re.groups and 1), changed, kind


def brackets(m, pattern):
    """(match, index of the closing bracket); the opening one ends the match."""
    for match in re.finditer(pattern, m, re.M):
        end = closing(m, match.end() - 1)
        if end > 0:
            yield match, end


def whole_statement(new):
    """Of a line whose brackets are closed on it."""
    return lambda match: new if match[1].count("(") == match[1].count(")") else None


def candidates(path, text, m):
    """(start, end, new, kind) of every fault. `m`: the text with strings and comments blanked out."""
    def line(match, end):
        return m[m.rfind("\n", 0, match.start()) + 1:end]

    lengths = {found.start() + length.start(1) for found in re.finditer(ARRAY, m, re.M)
               for length in re.finditer(r"(?:\[|, )(\d+)[\]>]", found[0])}
    yield from each(m, "constant", r"(?<![\w.'])(?:0[xX][0-9a-fA-F]+|(?:\d+\.\d*|\d+)(?:[eE][-+]?\d+)?|\.\d+)"
                    r"[fFuUlL]*(?![\w.'])", lambda match: None if match.start() in lengths else number(match))
    for match in re.finditer(r" (<=|>=|==|!=|<|>)(?= )", m):
        early = match[1] == "<" and re.search(r"\bfor \([^;]*;[^;]*$", line(match, match.start()))
        yield *match.span(1), "+ 1 <" if early else COMPARISON[match[1]], "comparison"
    for match in re.finditer(r" (\+=|-=|\*=|/=|\|=|&=|&&|\|\||and|or|%|&|\|(?! None)|<<|>>)(?=\s)", m):
        around = line(match, m.find("\n", match.end()))
        if match[1] not in ("<<", ">>") or not (around.count(match[1]) > 1 or '"' in around):
            yield *match.span(1), OPERATOR[match[1]], "operator"
    for match in re.finditer(r"(?<=[\w)\]]) ([-+*/]) (?=[^\s\"])", m):
        # Strings are also joined with +, and have no other operator.
        if match[1] == "+" and '"' in line(match, m.find("\n", match.end())):
            continue
        end = term_end(m, match.end(), match[1])
        yield *match.span(1), OPERATOR[match[1]], "operator"
        if end > match.end():
            yield match.start(), end, "", "dropped term"
        left = re.search(r"(?<![\w.>\])])[\w.]+$", m[max(0, match.start() - 40):match.start()])
        right = re.compile(r"[\w.]+(?![\w.(\[]|->)").match(m, match.end())
        if match[1] in "-/" and left and right:
            yield (match.start() - len(left[0]), right.end(), f"{right[0]} {match[1]} {left[0]}",
                   "swapped operands")
    yield from each(m, "other word", r"(?<![\w.])\w+(?=\()|\b(?:true|false|True|False|continue|break)\b",
                    lambda match: WORD.get(match[0]))
    yield from each(m, "other component", r"(?<=[\w\])]\.)[xyz]\b(?!\()",
                    lambda match: "xyz"["xyz".index(match[0]) - 2])
    for match in re.finditer(r"(?<![\w.])([\w.:]+)\(([\w.\[\]]+), ([\w.\[\]]+)\)", m):
        if match[2] != match[3] and not COMMUTATIVE.search(match[1]):
            yield match.start(2), match.end(3), f"{match[3]}, {match[2]}", "swapped arguments"
    for match in re.finditer(r"\? ([\w.\"]+) : ([\w.\"]+)(?=[;,)\s])", m):
        one, other = text[slice(*match.span(1))], text[slice(*match.span(2))]
        yield match.start(1), match.end(2), f"{other} : {one}", "swapped arguments"
    if path.endswith(".py"):
        yield from each(m, "dropped negation", r"\bnot (?=\w|\()", "")
        yield from each(m, "removed check", r"\bif ([^\n:]+):\s", "False")
        yield from each(m, "dropped statement", r"^ +((?!return|raise|yield|pass|import|from|assert|def|class"
                        r"|del|if|for|while|with|else)[\w.]+(?:\([^\n]*\)| [-+*|&/]?= [^\n(]+))$",
                        whole_statement("pass"))
        return
    yield from each(m, "dropped negation", r"(?<![\w)\]=!<>])!(?=[\w(:])", "")
    for match, end in brackets(m, r"\bif \("):
        condition = m[match.end():end]
        if ";" not in condition and not re.match(ENDS_EARLY, condition):
            yield match.end(), end, "false", "removed check"
        if ";" not in condition and not re.match(SAVES_TIME, condition):
            yield match.end(), end, "true", "forced branch"
    yield from each(m, "dropped statement", r"^ +(?!return|throw|if|for|while|else|case|using|static|const"
                    r"|delete|break|continue|fail|invalidArgument)"
                    r"([A-Za-z_][\w.:>\[\]-]*(?:\([^\n]*\)| [-+*|&/]?= [^\n]+);)$", whole_statement(";"))
    for match, end in brackets(m, r"\b(?:cl::)?check\("):
        if (comma := m.rfind(",", match.end(), end)) > 0:
            yield match.start(), end + 1, f"(void)({text[match.end():comma]})", "unchecked return"


def end_of_argument(m, at):
    while m[at] not in ",)":
        at = closing(m, at) + 1 if m[at] in "([{" else at + 1
    return at


def meanings(path, text, m):
    """Faults larger than an expression: statements that one forgets, or deletes as superfluous."""
    if path.endswith(".py"):
        yield from each(m, "dropped early return", r"\bif ([^\n:]+):\s+(?:return|continue|break)\b", "False")
        yield from each(m, "dropped clear", r"^ +([\w.]+\.clear\(\))$", "pass")
        yield from each(m, "dropped part", r" (?:and|or) [\w.]+(?=[:)\n])", "")
        return
    for match, end in brackets(m, r"^ +([^\n;{}=]*\b(?:fill|clear|reset|memset)\()"):
        if m[end + 1:end + 2] == ";":
            yield match.start(1), end + 2, ";", "dropped clear"
    yield from each(m, "dropped clear", r"\ballocateZeros\(", "allocate(")
    for match, end in brackets(m, rf"\bif \((?!{ENDS_EARLY})"):
        if re.compile(r"\)\s+\{?\s*(?:return|continue|break)\b").match(m, end):
            yield match.end(), end, "false", "dropped early return"
    # A side without brackets of its own, or with one pair.
    side = r"!?[\w.>\[\]-]+(?:\([^()]*\))?(?: (?:[=!]=|[<>]=?) [\w.>\[\]-]+(?:\([^()]*\))?)?"
    yield from each(m, "dropped part", rf" (?:&&|\|\|)\s+{side}(?=[;,)\s])", "")
    yield from each(m, "dropped part", rf"(?<=[(\s]){side} (?:&&|\|\|)\s+", "")
    for match, end in brackets(m, r"\.addPart\("):
        yield match.start(), end + 1, "", "dropped part"
    for match in re.finditer(r',?\s*\{"[^"\n]*", ', m):
        end = closing(m, m.index("{", match.start()))
        if end > 0 and (match[0][0] == "," or m[end + 1:end + 2] == ","):
            yield match.start(), end + (1 if match[0][0] == "," else 2), "", "dropped part"
    yield from each(m, "neighbour left out", r"= (-\w+); \w+ <= \w+;", "0")
    yield from each(m, "neighbour left out", r"= -\w+; \w+ <= (\w+);", "0")
    for match, end in brackets(m, r"\b(?:std::)?f?(?:min|max)w?\("):
        middle = end_of_argument(m, match.end())
        if m[middle] == "," and end_of_argument(m, middle + 1) == end:
            yield match.start(), end + 1, text[match.end():middle], "neighbour left out"
            yield match.start(), end + 1, text[middle + 2:end], "neighbour left out"
    yield from each(m, "neighbour left out", r"(?<=[\w)]) [-+] 1(?=\])", "")


NOTHING_CHANGES = re.compile(r"\breserve\(|(?i:prefetch)\(|static_assert|\btemplate\b|__attribute__|PEL_API"
                             r"|\boperator\b|^\s*(?:from|import)\b|\bassert\b|#pragma|noexcept")


def faults(path, text, meaning=False):
    """One fault for each line of `text` that has any; with `meaning` of the larger kind."""
    m = masked(path, text)
    lines, starts, shown, by_line, row = text.split("\n"), [0], {}, {}, 0
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    for found in sorted(set((meanings if meaning else candidates)(path, text, m))):
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
