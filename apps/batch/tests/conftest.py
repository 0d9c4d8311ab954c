import pytest

import pellucid as pel


@pytest.fixture(scope="session")
def device():
    return pel.Device()
