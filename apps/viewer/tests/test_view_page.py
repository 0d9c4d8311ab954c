"""The viewer's page in a real browser without a screen."""
import base64
import io
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zipfile

import numpy as np
import pytest
from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from view_session import renders_again

from pellucid.view.look import Look

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


# The viewer, whose device is gone once the file LOST is there, without smooth edges and with small exports.
PROGRAM = """
import os, sys
import pellucid as pel
import pellucid.view.export
import pellucid.view.session
pellucid.view.session.SAMPLES = 1
pellucid.view.export.export.__defaults__ = 320, 180, False
flag, execute, lost = sys.argv.pop(1), pel.Shader.execute, []
def broken(shader):
    if os.path.exists(flag):
        lost.append(shader.device)
        os.remove(flag)
    if any(shader.device is device for device in lost):
        raise pel.PellucidError(pel.ErrorCode.NO_DEVICE, "the device is gone")
    return execute(shader)
pel.Shader.execute = broken
from pellucid.view.__main__ import main
raise SystemExit(main())
"""


def refused(url):
    """Whether the server is there and lets nobody in."""
    try:
        urllib.request.urlopen(url)
    except urllib.error.HTTPError as error:
        return error.code == 403
    except OSError:
        pass
    return False


@pytest.fixture(scope="module")
def lost(tmp_path_factory):
    return tmp_path_factory.mktemp("lost") / "LOST"


@pytest.fixture(scope="module")
def address(tmp_path_factory, lost):
    folder = tmp_path_factory.mktemp("view")
    (folder / "look.json").write_text(json.dumps(Look(profile="custom", distance=(1.2, 0.6, 0.4)).to_dict()))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    log = folder / "log"
    # As a program of its own: pytest's variable would make NiceGUI wait for a test client.
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST", "NICEGUI"))}
    environment["XDG_CONFIG_HOME"] = str(folder / "config")
    process = subprocess.Popen([sys.executable, "-c", PROGRAM, str(lost), "--no-browser", "--port", str(port),
                                "--subdivide", "1", "--look", str(folder / "look.json")],
                               stdout=log.open("w"), stderr=subprocess.STDOUT, env=environment, cwd=folder,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    try:
        found = wait_for(lambda: process.poll() is not None
                         or re.search(r"http://\S+token=\S+", log.read_text()), "the address")
        if process.poll() is not None and "OpenGL" in log.read_text():
            pytest.skip("no OpenGL")
        assert process.poll() is None, log.read_text()
        url = found.group(0)
        wait_for(lambda: refused(url.split("?")[0]), "the server")
        yield url
        process.send_signal(signal.SIGINT)  # Ctrl-C, the way to end it
        assert process.wait(PATIENCE) == 0 and "Traceback" not in log.read_text(), log.read_text()
    finally:
        process.kill()
        process.wait(PATIENCE)


@pytest.fixture(scope="module")
def page(address, tmp_path_factory):
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=900,700"):
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
    counts = []

    def rests():
        """Whether no further picture comes for a while."""
        counts.append(page.execute_script(
            "return window.pelMoving || window.pelStandsIn ? null : window.pelFrames"))
        return len(counts) > 8 and None not in counts[-8:] and len(set(counts[-8:])) == 1

    wait_for(rests, "the picture at rest")
    data = page.execute_script("return document.getElementById('pel-canvas').toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGB")).astype(int)


def differ(a, b):
    return a.shape != b.shape or np.abs(a - b).mean() > 0.05


def act_and_compare(page, act):
    before = picture(page)
    count = page.execute_script("return window.pelFrames")
    act()
    wait_for(lambda: page.execute_script("return window.pelFrames") > count, "another picture")
    return before, picture(page)


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
    canvas = page.find_element(By.ID, "pel-canvas")
    origin = webdriver.common.actions.wheel_input.ScrollOrigin.from_element(canvas)
    before, after = act_and_compare(page,
                                    lambda: ActionChains(page).scroll_from_origin(origin, 0, -300).perform())
    assert differ(before, after)


def press(page, *keys):
    actions = ActionChains(page)
    for key in keys[:-1]:
        actions.key_down(key)
    actions.send_keys(keys[-1])
    for key in keys[:-1]:
        actions.key_up(key)
    actions.perform()


def test_keys_frame_turn_undo_and_explain(page):
    press(page, "f")
    press(page, "1")
    front = picture(page)
    before, side = act_and_compare(page, lambda: press(page, "3"))
    assert differ(front, side) and front.max() > 150
    assert not differ(front, act_and_compare(page, lambda: press(page, Keys.CONTROL, "z"))[1])
    assert not differ(side, act_and_compare(page, lambda: press(page, Keys.CONTROL, "y"))[1])
    canvas = page.find_element(By.ID, "pel-canvas")
    page.execute_script("arguments[0].width = arguments[0].height = 64", canvas)
    shot = np.asarray(Image.open(io.BytesIO(canvas.screenshot_as_png)))
    assert (shot[-3, -3, :3] == 0x11).all(), "a scene's picture keeps its shape"
    press(page, "1")
    pivoted = act_and_compare(page, lambda: ActionChains(page, duration=0).move_to_element_with_offset(
        canvas, 0, -60).double_click().perform())[1]
    assert differ(front, pivoted)  # what was above the middle is the middle
    probe = page.find_element(By.ID, "pel-probe")
    wait_for(probe.is_displayed, "the probe")
    assert "N·L of the key light" in probe.text and "scattering: " in probe.text
    framed = act_and_compare(page, lambda: press(page, "f"))[1]
    assert not differ(front, framed)
    press(page, "?")
    wait_for(lambda: [e for e in page.find_elements(By.XPATH, "//*[text()='frame the object']")
                      if e.is_displayed()], "the list of keys")
    press(page, Keys.ESCAPE)


def unfold(page, heading):
    """Opens a panel, if it is not open."""
    title = page.find_element(By.XPATH, f"//*[contains(@class,'q-expansion-item')]//*[text()='{heading}']")
    if title.find_elements(By.XPATH, "./ancestor::*[contains(@class,'q-expansion-item--collapsed')]"):
        page.execute_script("arguments[0].scrollIntoView({block: 'center'})", title)
        title.click()
        content = title.find_element(By.XPATH, "./ancestor::*[contains(@class,'q-expansion-item')][1]")
        heights = [-2, -1]  # it slides open

        def still():
            heights.append(content.size["height"])
            time.sleep(0.2)
            return heights[-1] == heights[-2] == heights[-3]
        wait_for(still, "the open panel")


def click_slider(page, name, share):
    slider = page.find_element(By.CSS_SELECTOR, f"[data-pel='{name}']")
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", slider)
    ActionChains(page, duration=0).move_to_element_with_offset(
        slider, int((share - 0.5) * slider.size["width"]), 0).click().perform()


def upload(page, label, path):
    box = f"//*[contains(@class,'q-uploader')][.//*[contains(text(),'{label}')]]"
    entry = page.find_element(By.XPATH, box + "//input[@type='file']")
    entry.send_keys(str(path))


def test_a_slider_changes_the_picture_and_builds_nothing(page):
    unfold(page, "Material")
    kernels = page.execute_script("return window.pelKernels")
    for share in (0.15, 0.85):
        assert differ(*act_and_compare(page, lambda to=share: click_slider(page, "slider-roughness", to)))
    # Kernels built at rest may be counted now; test_view.py checks that sliders build none after that.
    assert page.execute_script("return window.pelKernels") <= kernels + 4


def test_a_lost_device_is_reported_and_opened_again(page, lost):
    lost.touch()
    click_slider(page, "slider-exposure", 0.3)
    box = page.find_element(By.ID, "pel-error")
    wait_for(box.is_displayed, "the message")
    assert "the device is gone" in box.text
    count = page.execute_script("return window.pelFrames")
    page.find_element(By.ID, "pel-again").click()
    wait_for(lambda: page.execute_script("return window.pelFrames") > count, "a picture")
    assert not box.is_displayed() and picture(page).std() > 10
    # Widgets set the new session: pixels are counted on demand.
    unfold(page, "Statistics")

    def counts():
        return page.find_element(By.CSS_SELECTOR, "[data-pel='counts']").text

    wait_for(lambda: "pixels shaded" in counts(), "the panel")
    assert "pixels eye" not in counts()
    page.find_element(By.CSS_SELECTOR, "[data-pel='count']").click()
    wait_for(lambda: re.search(r"pixels eye [1-9]", counts()), "the counts")


def test_export_renders_again(page, tmp_path):
    unfold(page, "Export")
    pack = wait_for(lambda: [b for b in page.find_elements(By.CSS_SELECTOR, "[data-pel='export']")
                             if b.is_displayed()], "the button")[0]
    page.execute_script("arguments[0].scrollIntoView({block: 'center'})", pack)
    pack.click()
    archive = wait_for(lambda: list(page.downloads.glob("*.zip")), "the download")[0]
    with zipfile.ZipFile(archive) as z:
        z.extractall(tmp_path)
    folder = tmp_path / "pellucid-look"
    assert json.loads((folder / "look.json").read_text())["method"] in ("auto", "preintegrated")
    assert renders_again(folder)


def test_a_bad_mesh_is_shown_and_the_old_one_stays(page, tmp_path):
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nf 1 2 3\n")
    before = picture(page)
    upload(page, "Drop an OFF", bad)
    shown = wait_for(lambda: [e.text for e in page.find_elements(By.CSS_SELECTOR, ".q-notification")
                             if "obj" in e.text], "a message")
    assert "3" in shown[0] or "vertex" in shown[0]
    wait_for(lambda: not page.find_elements(By.CSS_SELECTOR, ".q-uploader__file--uploaded"), "no tick")
    assert not differ(before, picture(page))


def test_an_iris_is_dropped_on_the_page(page, tmp_path):
    unfold(page, "Eyes")
    Image.new("RGB", (64, 64), (255, 0, 0)).save(tmp_path / "red.png")
    assert differ(*act_and_compare(page, lambda: upload(page, "image of an iris", tmp_path / "red.png")))
    back = wait_for(lambda: page.find_elements(By.CSS_SELECTOR, "[data-pel='iris-fibres']"), "the way back")
    assert differ(*act_and_compare(page, lambda: page.execute_script("arguments[0].click()", back[0])))
    wait_for(lambda: not page.find_elements(By.CSS_SELECTOR, "[data-pel='iris-fibres']"), "fibres")


def test_a_mesh_of_another_unit_brings_a_question(page, tmp_path):
    mesh = tmp_path / "metres.obj"
    mesh.write_text("v 0 0 0\nv .24 0 0\nv 0 .24 0\nv 0 0 .24\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    picture(page)
    upload(page, "Drop an OFF", mesh)
    yes = wait_for(lambda: page.find_elements(By.CSS_SELECTOR, "[data-pel='unit-yes']"), "the question")[0]
    card = yes.find_element(By.XPATH, "./ancestor::*[contains(@class,'q-card')]")
    text = wait_for(lambda: card.text, "its text, which is nothing while it appears")
    assert "0.24 mm across" in text and "lengths in metres?" in text
    yes.click()
    wait_for(lambda: not page.find_elements(By.CSS_SELECTOR, "[data-pel='unit-yes']"), "the end of it")
