"""A session of the viewer, which the tests share."""
import pytest


@pytest.fixture(scope="session")
def shared_session():
    """A session with the package's head."""
    from pellucid import files
    from pellucid.view.session import Session

    try:
        made = Session()
    except RuntimeError as error:
        pytest.skip(f"no OpenGL: {error}")
    made.load(files.standard_head(), subdivide=1)
    return made


@pytest.fixture
def session(shared_session):
    """The same as it begins."""
    from view_session import reset

    reset(shared_session)
    return shared_session
