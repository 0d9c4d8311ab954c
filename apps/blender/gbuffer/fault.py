"""Something that the user can put right."""

import sys


class Fault(Exception):
    """The message says what was wrong, where, and what would be right."""


def warn(text):
    print(f"render_gbuffer.py: warning: {text}", file=sys.stderr, flush=True)
