"""Devices, events and buffers."""
import numpy as np
import pytest

import pellucid as pel


def test_devices_are_listed_picked_and_named():
    infos = pel.devices()
    assert infos and all(i.name and i.compute_units > 0 and i.global_memory_bytes > 0 for i in infos)
    assert [i.index for i in infos] == list(range(len(infos))) and pel.Device(0).info.name == infos[0].name
    seen = []
    pel.set_error_callback(lambda code, message: seen.append((code, message)))
    try:
        with pytest.raises(pel.PellucidError, match=infos[0].name[:8].replace("(", r"\(")) as caught:
            pel.Device("no such device")
    finally:
        pel.set_error_callback(None)
    assert caught.value.code is pel.ErrorCode.NO_DEVICE and seen == [(caught.value.code, str(caught.value))]


def test_the_log_hears_errors_with_names(device):
    heard = []
    shader = pel.Shader(device).set_name("hero")
    pel.set_log_callback(lambda *line: heard.append(line))
    try:
        with pytest.raises(pel.PellucidError, match="^hero: "):
            shader.commit()
    finally:
        pel.set_log_callback(None)
    assert [(level, name) for level, name, _ in heard] == [(pel.LogLevel.ERROR, "hero")]
    own = pel.Device()
    own.set_name("second GPU")
    with pytest.raises(pel.PellucidError, match="^second GPU: "):
        pel.Buffer(own, 1 << 60)


def test_buffer_round_trip(device):
    values = np.arange(1000, dtype=np.int64)
    buffer, out = pel.Buffer(device, values), np.empty_like(values)
    assert buffer.nbytes == values.nbytes
    first = buffer.submit_write(np.full(3, -1, np.int64), offset=80)
    second = buffer.submit_read(out, waits=[first])
    second.wait()
    values[10:13] = -1
    assert first.done and second.done and np.array_equal(out, values)
    assert not pel.Buffer(device, 64).read(np.ones(64, np.uint8)).any()


def test_host_memory_is_used_in_place(device):
    memory = np.zeros(4096, np.uint8)
    buffer = pel.Buffer.from_host(device, memory)
    before = device.stats()
    with buffer.mapped() as view:
        view[:4] = [1, 2, 3, 4]
    with buffer.mapped() as view:
        assert view[:4].tolist() == [1, 2, 3, 4]
    assert memory[:4].tolist() == [1, 2, 3, 4]
    if device.info.shared_memory:
        assert device.stats().bytes_to_device == before.bytes_to_device


@pytest.mark.parametrize("use, error", [
    (lambda d: pel.Buffer(d, 0), pel.PellucidError),
    (lambda d: pel.Buffer(d, 8).read(np.empty(9, np.uint8)), pel.PellucidError),
    (lambda d: pel.Buffer(d, 8).write(np.empty(4, np.uint8), offset=5), pel.PellucidError),
    (lambda d: pel.Buffer(d, 80).read(np.empty((4, 4), np.uint8)[:, 1]), ValueError),
    (lambda d: pel.Buffer(d, 80).write(np.ones((4, 4), np.uint8)[:, 1]), ValueError),
    (lambda d: pel.Buffer.from_host(d, np.zeros((8, 8))[:, ::2]), ValueError),
    (lambda d: pel.Buffer.from_cl(d, None), TypeError),
    (lambda d: pel.Device.from_cl("queue"), TypeError),
])
def test_wrong_use_raises_and_leaves_the_device_usable(device, use, error):
    with pytest.raises(error):
        use(device)
    assert pel.Buffer(device, np.ones(3)).read(np.empty(3)).tolist() == [1, 1, 1]
