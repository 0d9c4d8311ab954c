"""The viewer's page in a real browser without a screen."""
import base64
import io
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zipfile

import numpy as np
import pytest

files = pytest.importorskip("pellucid.files", reason="this build reads no files")
webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed")
Image = pytest.importorskip("PIL.Image", reason="pillow is not installed")
pytest.importorskip("moderngl", reason="moderngl is not installed")
pytest.importorskip("nicegui", reason="nicegui is not installed")
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="chromium is not installed")
PATIENCE = 120  # seconds: kernels are compiled at the first picture


def wait_for(condition, what, seconds=PATIENCE):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"waited {seconds} s for {what}")


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    log = tmp_path_factory.mktemp("view") / "log"
    # As a program of its own: pytest's variable would make NiceGUI wait for a test client.
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST", "NICEGUI"))}
    process = subprocess.Popen([sys.executable, "-m", "pellucid.view", "--no-browser", "--port", str(port), "--subdivide", "1"],
                               stdout=log.open("w"), stderr=subprocess.STDOUT, env=environment, cwd=log.parent)
    try:
        found = wait_for(lambda: process.poll() is not None or re.search(r"http://\S+token=\S+", log.read_text()), "the address")
        if process.poll() is not None and "OpenGL" in log.read_text():
            pytest.skip("no OpenGL")
        assert process.poll() is None, log.read_text()
        url = found.group(0)

        def up():
            try:
                urllib.request.urlopen(url.split("?")[0])
            except urllib.error.HTTPError as error:
                return error.code == 403
            except OSError:
                return False

        wait_for(up, "the server")
        yield url
    finally:
        process.terminate()
        process.wait(20)


@pytest.fixture(scope="module")
def page(address, tmp_path_factory):
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1000,700"):
        options.add_argument(argument)
    options.binary_location = CHROMIUM
    downloads = tmp_path_factory.mktemp("downloads")
    options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    driver.downloads = downloads
    try:
        driver.get(address)
        wait_for(lambda: driver.execute_script("return window.pelFrames"), "the first picture")
        yield driver
    finally:
        driver.quit()


def picture(page):
    """The picture at rest, as an array."""
    wait_for(lambda: page.execute_script("return window.pelMoving === false"), "the picture at rest", 20)
    last, same = None, 0
    for _ in range(200):
        count = page.execute_script("return window.pelFrames")
        same = same + 1 if count == last else 0
        last = count
        if same > 4:
            break
        time.sleep(0.1)
    data = page.execute_script("return document.getElementById('pel-canvas').toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGB")).astype(int)


def differ(a, b):
    return a.shape != b.shape or np.abs(a - b).mean() > 0.05


def act_and_compare(page, act):
    before = picture(page)
    count = page.execute_script("return window.pelFrames")
    act()
    wait_for(lambda: page.execute_script("return window.pelFrames") > count, "another picture", 30)
    return before, picture(page)


def test_nobody_gets_in_without_the_token(address):
    plain = address.split("?")[0]
    for url in (plain, plain + "?token=wrong", plain + "frames"):
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(url)
        assert refused.value.code == 403


def test_it_shows_a_head(page):
    seen = picture(page)
    assert seen.max() > 150 and seen.std() > 20
    assert not page.find_element(By.ID, "pel-error").is_displayed()


@pytest.mark.parametrize("key", [None, Keys.SHIFT, Keys.CONTROL])
def test_dragging_turns_moves_and_lights(page, key):
    def drag():
        actions = ActionChains(page, duration=20)
        if key:
            actions.key_down(key)
        actions.click_and_hold(page.find_element(By.ID, "pel-canvas"))
        for _ in range(8):
            actions.move_by_offset(10, 2)
        actions.release()
        if key:
            actions.key_up(key)
        actions.perform()

    before, after = act_and_compare(page, drag)
    assert differ(before, after)


def test_the_wheel_zooms(page):
    before, after = act_and_compare(page, lambda: ActionChains(page).scroll_from_origin(
        webdriver.common.actions.wheel_input.ScrollOrigin.from_element(page.find_element(By.ID, "pel-canvas")), 0, -300).perform())
    assert differ(before, after)


@pytest.mark.parametrize("name", ["exposure", "radius_scale", "specular", "roughness", "f0", "pores", "albedo-1", "target_error", "transmission"])
def test_sliders_change_the_picture(page, name):
    slider = page.find_element(By.CSS_SELECTOR, f"[data-pel='slider-{name}']")
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", slider)

    def pull():
        width = slider.size["width"]
        ActionChains(page).move_to_element_with_offset(slider, int(0.4 * width), 0).click().perform()

    before, after = act_and_compare(page, pull)
    if name not in ("target_error", "transmission"):  # where nothing thin is lit from behind, they may change nothing that shows
        assert differ(before, after)


def test_export_renders_again(page, tmp_path):
    button = page.find_element(By.XPATH, "//*[contains(@class,'q-expansion-item')]//*[text()='Export']")
    page.execute_script("arguments[0].scrollIntoView()", button)
    button.click()
    pack = wait_for(lambda: [b for b in page.find_elements(By.CSS_SELECTOR, "[data-pel='export']") if b.is_displayed()], "the button", 10)[0]
    time.sleep(0.5)
    pack.click()
    archive = wait_for(lambda: list(page.downloads.glob("*.zip")), "the download", 60)[0]
    with zipfile.ZipFile(archive) as z:
        z.extractall(tmp_path)
    folder = tmp_path / "pellucid-look"
    assert json.loads((folder / "look.json").read_text())["method"] == "auto"
    command = os.environ.get("PELLUCID_COMMAND")
    if not command:
        pytest.skip("the pellucid command is not built")
    subprocess.run([command, "shade", "gbuffer.exr", "--scene", "scene.toml", "-o", "again.exr"], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)
    one, two = (files.read_image(folder / name) for name in ("picture.exr", "again.exr"))
    assert all(np.array_equal(one[c], two[c]) for c in "RGB")


def test_a_bad_mesh_is_shown_and_the_old_one_stays(page, tmp_path):
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nf 1 2 3\n")
    before = picture(page)
    entry = [e for e in page.find_elements(By.CSS_SELECTOR, "input[type=file]")][0]
    entry.send_keys(str(bad))
    told = wait_for(lambda: [e.text for e in page.find_elements(By.CSS_SELECTOR, ".q-notification") if "obj" in e.text], "a message", 20)
    assert "3" in told[0] or "vertex" in told[0]
    assert not differ(before, picture(page))
