"""Formulas of a page, which stand there as text between backticks, as MathML, which browsers typeset."""

import re
import unicodedata

from latex2mathml.converter import convert

FUNCTIONS = "sin cos tan acos atan asin exp log sinh erf max min mod".split()
RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ⁿⁱ", "0123456789-+ni"))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉₋₊ᵢₖₙ", "0123456789-+ikn"))
SIGNS = {
    "−": "-", "·": r"\cdot ", "×": r"\times ", "≤": r"\le ", "≥": r"\ge ", "≠": r"\ne ", "∞": r"\infty ",
    "∫": r"\int ", "Σ": r"\sum ", "∂": r"\partial ", "½": r"\tfrac{1}{2}", "¼": r"\tfrac{1}{4}",
    "¾": r"\tfrac{3}{4}", "│": "|", "→": r"\to ", "′": "'", "≈": r"\approx ", "ℓ": r"\ell ",
}  # fmt: skip
MATHEMATICAL = re.compile(f"[{''.join(RAISED) + ''.join(LOWERED) + ''.join(SIGNS)}√α-ωΑ-Ω]")
NAMES = re.compile(r"[\"`#\\]|--|\.[a-z]{1,3}$|[a-z]{2}_[a-z]{2}|[a-z]/[a-z]{3}")  # of files, options, fields
PLAIN = re.compile(r"\w{1,2}$|\w_\w$|\w{1,4} ?\(.*\)( [=<>].*)?$|[\w ]{1,5} [=<>+*/-] .*$|\w\w \w\w$")
WORD = re.compile(r"[A-Za-z]{4,}")


def is_formula(text):
    if NAMES.search(text):
        return False
    words = [w for w in WORD.findall(text) if w not in FUNCTIONS]
    return bool(MATHEMATICAL.search(text) or (PLAIN.match(text) and not words))


def closing(text, at):
    """The end of the bracket that opens at `at`."""
    depth = 0
    for i in range(at, len(text)):
        depth += (text[i] in "({") - (text[i] in ")}")
        if depth == 0:
            return i
    raise ValueError(f"an open bracket: {text}")


def argument(text, at):
    """What a root or an exponent at `at` takes: a bracket without its parentheses, or one sign."""
    if text[at] in "({":
        end = closing(text, at)
        return tex(text[at + 1 : end]), end + 1
    word = re.match(r"[A-Za-z]{2,}|\d*\.?\d+|−?\w[₀-₉]*|.", text[at:])
    return tex(word[0]), at + word.end()


def tex(text):
    out, i = "", 0
    while i < len(text):
        c = text[i]
        word = re.match(r"[A-Za-z]+\d?", text[i:])
        if c in RAISED or c in LOWERED:
            table = RAISED if c in RAISED else LOWERED
            run = re.match(f"[{''.join(table)}]+", text[i:])[0]
            out += ("^" if table is RAISED else "_") + "{" + "".join(table[s] for s in run) + "}"
            i += len(run)
        elif c == "√" or c in "^_":
            inner, i = argument(text, i + 1)
            out += (r"\sqrt" if c == "√" else c) + "{" + inner + "}"
        elif word:
            name, i = word[0], i + word.end()
            letters = name.rstrip("0123456789")
            if letters in FUNCTIONS and name == letters:
                out += rf"\operatorname{{{name}}} "
            elif re.fullmatch("d[a-zA-Z]", name):
                out += rf"\,\mathrm{{d}}{name[1]}"
            elif len(letters) == 1:
                out += letters + (f"_{{{name[1:]}}}" if name[1:] else "")
            elif re.fullmatch("[a-z]{2}", name):  # a product
                out += name
            elif re.fullmatch("[A-Z][a-z]", name):
                out += f"{name[0]}_{{{name[1]}}}"
            else:
                out += rf"\mathrm{{{name}}}"
        elif c in SIGNS:
            out, i = out + SIGNS[c], i + 1
        elif "GREEK" in unicodedata.name(c, ""):
            parts = unicodedata.name(c).split()
            name = parts[-1].lower()
            out, i = out + "\\" + (name if parts[1] == "SMALL" else name.capitalize()) + " ", i + 1
        else:
            out, i = out + {"{": r"\{", "}": r"\}", "%": r"\%", "&": r"\&"}.get(c, c), i + 1
    return out


def typeset(page):
    """The text of a page with MathML in place of its formulas."""

    def one(match):
        text = " ".join(match[1].split())
        return convert(tex(text)) if is_formula(text) else match[0]

    blocks = re.split(r"(?ms)(^```.*?^```$)", page)
    return "".join(b if b.startswith("```") else re.sub(r"(?<!`)`([^`]+)`(?!`)", one, b) for b in blocks)
