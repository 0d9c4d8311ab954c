"""A session of the viewer, which the tests share."""
import pytest


@pytest.fixture(scope="module")
def session():
    """A session with the package's head; modules that use it import moderngl first."""
    from pellucid import files
    from pellucid.view.session import Session

    try:
        made = Session()
    except RuntimeError as error:
        pytest.skip(f"no OpenGL: {error}")
    made.load(files.standard_head(), subdivide=1)
    return made
