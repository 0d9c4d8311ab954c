"""What is printed: what the user can put right, and nothing that Blender prints while it renders."""

import contextlib
import os
import sys

VERBOSE = False


class Fault(Exception):
    """The message says what was wrong, where, and what would be right."""


def warn(text):
    print(f"render_gbuffer.py: warning: {text}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def quiet():
    """Standard output goes nowhere meanwhile, also that of C code; errors still come out."""
    if VERBOSE:
        yield
        return
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)
