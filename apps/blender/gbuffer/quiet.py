"""Keeps what Blender itself prints while it renders out of the log."""

import contextlib
import os
import sys

VERBOSE = False


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
