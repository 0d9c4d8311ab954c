"""Faults of a larger kind than an expression: a dropped clear or early return, a condition or key without
one of its parts, a neighbour left out. Each is what somebody forgets, or deletes as superfluous."""
import re


def closing(text, opening):
    """The index of the bracket that closes the one at `opening`, or -1."""
    depth = 0
    for i in range(opening, len(text)):
        depth += (text[i] in "([{") - (text[i] in ")]}")
        if depth == 0:
            return i
    return -1


def end_of_operand(m, at):
    """Where an operand of && or || ends."""
    while at < len(m) and not re.compile(r"&&|\|\||[;,?)\]}]").match(m, at):
        at = closing(m, at) + 1 if m[at] in "([{" else at + 1
        if at == 0:
            return -1
    return at


def begin_of_operand(m, at):
    """Where the operand of && or || that ends at `at` begins."""
    depth = 0
    while at > 0:
        depth += (m[at - 1] in ")]}") - (m[at - 1] in "([{")
        if depth < 0 or (depth == 0 and re.search(r"(?:&&|\|\||[;,?]|(?<![!<>=])=|\breturn) ?$",
                                                  m[max(0, at - 8):at])):
            return at
        at -= 1
    return -1


def arguments(m, opening):
    """(begin, end) of the arguments of a call."""
    end, begin, parts = closing(m, opening), opening + 1, []
    at = begin
    while 0 < at < end:
        if m[at] == ",":
            parts.append((begin, at))
            begin = at + 2
        at = closing(m, at) + 1 if m[at] in "([{" else at + 1
    return [*parts, (begin, end)] if end > 0 else []


def candidates(path, text, m):
    """(start, end, new, kind) of every fault. `m`: the text with strings and comments blanked out."""
    if path.endswith(".py"):
        for match in re.finditer(r"\bif ([^\n:]+):\s+(?:return|continue|break)\b", m):
            yield *match.span(1), "False", "dropped early return"
        for match in re.finditer(r"^ +([\w.]+\.clear\(\))$", m, re.M):
            yield *match.span(1), "pass", "dropped clear"
        for match in re.finditer(r" (?:and|or) [\w.]+(?=[:)\n])", m):
            yield *match.span(), "", "dropped part"
        return
    for match in re.finditer(r"^ +([^\n;{}=]*\b(?:fill|clear|reset|memset)\()", m, re.M):
        end = closing(m, match.end() - 1)
        if end > 0 and m[end + 1:end + 2] == ";":
            yield match.start(1), end + 2, ";", "dropped clear"
    for match in re.finditer(r"\ballocateZeros\(", m):
        yield *match.span(), "allocate(", "dropped clear"
    for match in re.finditer(r"\bif \(", m):
        end = closing(m, match.end() - 1)
        if end > 0 and re.compile(r"\)\s+\{?\s*(?:return|continue|break)\b").match(m, end):
            yield match.end(), end, "false", "dropped early return"
    for match in re.finditer(r" (?:&&|\|\|)(?=\s)", m):
        end, begin = end_of_operand(m, match.end()), begin_of_operand(m, match.start())
        if end > 0:
            yield match.start(), end, "", "dropped part"
        if begin > 0:
            yield begin, match.end() + 1, "", "dropped part"
    for match in re.finditer(r"\.addPart\(", m):
        yield match.start(), closing(m, match.end() - 1) + 1, "", "dropped part"
    for match in re.finditer(r',?\s*\{"[^"\n]*", ', m):
        end = closing(m, m.index("{", match.start()))
        if end > 0 and (match[0][0] == "," or m[end + 1:end + 2] == ","):
            yield match.start(), end + (1 if match[0][0] == "," else 2), "", "dropped part"
    for match in re.finditer(r"= (-\w+); (\w+) <= (\w+);", m):
        yield *match.span(1), "0", "neighbour left out"
        yield *match.span(3), "0", "neighbour left out"
    for match in re.finditer(r"\b(?:std::)?f?(?:min|max)w?\(", m):
        parts = arguments(m, match.end() - 1)
        if len(parts) == 2:
            for part in parts:
                yield match.start(), parts[1][1] + 1, text[slice(*part)], "neighbour left out"
    for match in re.finditer(r"(?<=[\w)]) [-+] 1(?=\])", m):
        yield *match.span(), "", "neighbour left out"
