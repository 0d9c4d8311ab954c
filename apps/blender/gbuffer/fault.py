"""Output: errors that the user can correct, without Blender's own output while it renders."""

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
    """Discards standard output in this scope, also that of C code; errors are still printed."""
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
