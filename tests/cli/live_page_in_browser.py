# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""live_page_in_browser.py CAIRN SOURCE_DIR [LivePage.TEST]: tests the page of `cairn live --view` in headless
Chromium: drawings against the results of `cairn segment`, options, pause and step, reconnection. Skipped under the
conditions in in_browser.py, and if views are not built. CAIRN_SCREENSHOTS=DIR keeps screenshots."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from in_browser import CAIRN, HOSTILE, SOURCE, PageTest, browser
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

TOKEN = "0123456789abcdef-of-a-test"
FRAMES = 3000  # at 5 Hz: outlasts every test without --loop, even on a busy machine


class Live:
    """A running `cairn live --view`."""

    def __init__(self, source, *arguments, at="127.0.0.1:0"):
        self.process = subprocess.Popen(
            [CAIRN, "live", str(source), "--view", at, "--view-token", TOKEN, *arguments], stderr=subprocess.PIPE, text=True)
        self.said = []
        self.is_ended = False
        self.url = None
        for line in self.process.stderr:
            self.said.append(line)
            if found := re.match(r"view: (\S+)", line):
                self.url = found[1]
                break
        threading.Thread(target=lambda: self.said.extend(self.process.stderr), daemon=True).start()
        if not self.url:
            raise RuntimeError("".join(self.said))

    @property
    def address(self):
        return re.match(r"http://([^/]+)/", self.url)[1]

    def end(self):
        self.is_ended = True
        self.process.terminate()
        self.process.wait(timeout=60)


def long_sequence(folder):
    """The ball rolls back and forth."""
    frames = sorted((SOURCE / "data" / "sequences" / "rolling_ball").glob("0*"))
    there_and_back = frames + frames[-2:0:-1]
    folder.mkdir()
    for k in range(FRAMES):
        (folder / f"{k:04}").symlink_to(there_and_back[k % len(there_and_back)])
    (folder / "stamps.txt").write_text("".join(f"{0.2 * k:.1f}\n" for k in range(FRAMES)))


def processor_ms(root):
    """Processor time of a process and its children so far, ms."""
    stats = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:  # it has ended
            continue
        stats[int(path.parent.name)] = (int(fields[1]), int(fields[11]) + int(fields[12]))
    family = {root}
    while more := {pid for pid, (parent, _) in stats.items() if parent in family} - family:
        family |= more
    return 1000 * sum(stats[pid][1] for pid in family if pid in stats) / os.sysconf("SC_CLK_TCK")


class LivePage(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.source = pathlib.Path(cls.folder.name) / HOSTILE
        long_sequence(cls.source)
        cls.browser = browser("--disable-3d-apis")  # like a computer without a GPU
        cls.browser.set_script_timeout(60)
        cls.lives = []

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()
        cls.folder.cleanup()

    def setUp(self):
        self.may_fail_to_connect = False
        self.lives = []

    def tearDown(self):
        self.browser.get("about:blank")
        ended = [(live.process.returncode, live.said) for live in self.lives if live.process.poll() and not live.is_ended]
        for live in self.lives:
            live.end()
        self.assertEqual(ended, [])  # by itself
        said = [entry["message"] for entry in self.browser.get_log("browser")]
        if self.may_fail_to_connect:
            said = [message for message in said if "ERR_CONNECTION" not in message and "WebSocket connection" not in message]
        self.assertEqual(said, [])

    # ---- helpers ----

    def live(self, *arguments, **more):
        self.lives.append(Live(self.source, *arguments, **more))
        return self.lives[-1]

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def wait_until(self, condition, what, seconds=60):
        until = time.time() + seconds
        while time.time() < until:
            if value := condition():
                return value
            time.sleep(0.05)
        self.fail(f"{what}: not within {seconds} s; the page says: {self.find('#link').text}, {self.find('.news').text!r}")

    def drawn(self):
        return self.script("return window.cairnStats.drawn")

    def look_at(self, live, frames=3):
        # localStorage persists between pages.
        self.browser.get(live.url)
        self.script("localStorage.clear()")
        self.browser.get(live.url)
        self.wait_until(lambda: self.drawn() >= frames, f"{frames} frames are drawn")

    def frame(self):
        """The server's newest message about a frame."""
        return self.browser.execute_async_script(
            "const done = arguments[0]; fetch('/status.json').then((r) => r.json()).then(done)")

    def pause(self):
        self.find("#pause").click()
        self.wait_until(lambda: self.find("#link").text == "paused", "it is paused")
        time.sleep(1.0)  # lets the current frame finish

    def step(self):
        before = self.frame()["frame"]
        self.find("#step").click()
        self.wait_until(lambda: self.frame()["frame"] == before + 1, "the next frame")

    def segmented(self, name, option):
        result = subprocess.run([CAIRN, "segment", str(self.source / name), "--json", "--set", option],
                                check=True, capture_output=True)
        return json.loads(result.stdout)["objects"]

    def option(self, name):
        return self.find(f".option[data-name='{name}']")

    def slide(self, name, share):
        self.script("const o = document.querySelector(`.option[data-name='${arguments[0]}']`), s = o.querySelector('input[type=range]');"
                    "o.closest('details').open = true; s.value = arguments[1]; s.dispatchEvent(new Event('input'))", name, share)

    def colours(self, selector):
        return set(self.script(
            "const c = document.querySelector(arguments[0]), copy = document.createElement('canvas');"
            "[copy.width, copy.height] = [c.width, c.height];"
            "const g = copy.getContext('2d', {willReadFrequently: true});"
            "g.drawImage(c, 0, 0);"
            "return [...new Set(new Uint32Array(g.getImageData(0, 0, c.width, c.height).data.buffer))]", selector))

    # ---- tests ----

    def test_draws_the_results_of_the_server(self):
        self.look_at(self.live("--tunable"), frames=25)
        self.pause()
        objects = self.frame()["objects"]
        self.assertGreater(len(objects), 0)
        ids = sorted(str(o["id"]) for o in objects)
        texts = self.wait_until(lambda: [m.text for m in self.find_all("[data-panel=picture] .mark")], "names")
        self.assertEqual(sorted(re.match(r"\d+", text)[0] for text in texts), ids)
        self.assertEqual(sorted(self.column("things", "id")), ids)
        shown = dict(zip(self.column("things", "id"), self.column("things", "distance m")))
        for each in objects:
            if each["distance_m"] is not None:
                self.assertEqual(shown[str(each["id"])], f"{each['distance_m']:.2f}")
        for canvas in ("[data-panel=picture] canvas", "[data-panel=picture] canvas:nth-of-type(2)", "[data-panel=disparity] canvas",
                       "[data-panel=scene] canvas"):
            self.assertGreater(len(self.colours(canvas)), 5, canvas)
        stats = self.script("return window.cairnStats")
        print(f"{stats['drawn']} frames drawn; from arrival until drawn {stats['p50_ms']:.1f} ms (median), {stats['p95_ms']:.1f} ms (95 %)")
        self.keep("live")

    def test_prints_how_fast_it_draws(self):
        """Sends a pair every 33 ms. Measures without a limit; a drawn frame is the only requirement. The preset
        `default` needs more than 33 ms of one processor per pair, so it receives what it can compute next to the
        browser; `paper` keeps up."""
        print(f"30 pairs a second to {os.cpu_count()} processors, load before {os.getloadavg()[0]:.1f}; Chromium without a graphics processor")
        for preset in ("default", "paper"):
            live = self.live("--pace", "6", "--loop", "--preset", preset)
            self.look_at(live, frames=30)
            for panels in ("all panels", "the left image alone"):
                if panels != "all panels":
                    ActionChains(self.browser).double_click(self.find("[data-panel=picture] canvas")).perform()
                time.sleep(20)  # its statistics cover the last 300 frames
                counts = lambda: [*self.script("return [performance.now(), window.cairnStats.received, window.cairnStats.drawn, window.cairnStats.computed]"),
                                  processor_ms(self.browser.service.process.pid), processor_ms(live.process.pid)]
                before = counts()
                time.sleep(12)
                after = counts()
                wall, received, drawn, computed, of_browser, of_cairn = (b - a for a, b in zip(before, after))
                self.assertGreater(drawn, 0)
                stats = self.script("return window.cairnStats")
                print(f"{preset}, {panels}: {1000 * computed / wall:.1f} frames a second computed, {1000 * received / wall:.1f} received, "
                      f"{1000 * drawn / wall:.1f} drawn; from arrival until drawn {stats['p50_ms']:.1f} ms (median), {stats['p95_ms']:.1f} ms (95 %); "
                      f"processor time: Chromium {of_browser / drawn:.1f} ms a drawn frame, cairn {of_cairn / max(1, computed):.1f} ms a computed one")
            self.browser.get("about:blank")
            live.end()

    def test_external_names_are_escaped(self):
        self.look_at(self.live("--tunable"))
        self.assertEqual(self.find("#title").text, HOSTILE)
        self.assertEqual(self.script("return document.querySelectorAll('#title *').length"), 0)

    def test_a_slider_changes_the_next_frame(self):
        self.look_at(self.live("--tunable", "--no-tracks"))
        self.pause()
        before = self.frame()
        following = f"{int(before['name']) + 1:04}"
        confidences = sorted(o["confidence"] for o in self.segmented(following, "objects.min_confidence=0.3"))
        least = round((confidences[0] + confidences[-1]) / 2, 2)
        self.slide("objects.min_confidence", least)
        self.wait_until(lambda: "changed" in self.option("objects.min_confidence").get_attribute("class"), "the server takes it")
        self.step()
        after = self.frame()
        self.assertEqual(after["revision"], before["revision"] + 1)
        self.assertEqual(after["name"], following)
        segmented = self.segmented(following, f"objects.min_confidence={least}")
        self.assertEqual([o["id"] for o in after["objects"]], [o["id"] for o in segmented])
        self.assertEqual([round(o["distance_m"], 3) for o in after["objects"]],
                         [round(sum(v * v for v in o["position_m"]) ** 0.5, 3) for o in segmented])
        self.wait_until(lambda: self.column("things", "id") == [str(o["id"]) for o in segmented], "the list follows")
        self.assertLess(len(segmented), len(confidences))
        self.keep("live_tuned")
        self.find("#reset").click()
        self.wait_until(lambda: "changed" not in self.option("objects.min_confidence").get_attribute("class"), "it is reset")

    def test_a_refused_value_is_reported_and_reset(self):
        self.look_at(self.live("--tunable"))
        self.script("document.querySelector('[data-section=match]').open = true")
        box = self.option("match.num_disparities").find_element("css selector", "input.value")
        first = box.get_attribute("value")
        box.clear()
        box.send_keys("99999", Keys.TAB)
        self.wait_until(lambda: "match.num_disparities" in self.option("match.num_disparities").text, "the refusal")
        self.assertIn("99999", self.find(".toast.error").text)
        self.wait_until(lambda: box.get_attribute("value") == first, "the value is as before")
        self.keep("live_refused")

    def test_options_are_found_and_copied(self):
        self.look_at(self.live("--tunable"))
        ActionChains(self.browser).send_keys("/").perform()
        self.find("#search").send_keys("confidence")
        names = [row.get_attribute("data-name") for row in self.find_all(".option") if row.is_displayed()]
        self.assertIn("objects.min_confidence", names)
        self.assertLess(len(names), 15)
        self.find("#search").clear()
        self.find("#search").send_keys(Keys.ESCAPE)
        self.slide("match.num_disparities", 0.55)
        self.wait_until(lambda: "changed" in self.option("match.num_disparities").get_attribute("class"), "the server takes it")
        self.browser.execute_cdp_cmd("Browser.grantPermissions", {"permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"]})
        self.find("#yaml").click()
        self.wait_until(lambda: self.find_all(".toast"), "it is copied")
        text = self.browser.execute_async_script("const done = arguments[0]; navigator.clipboard.readText().then(done, (e) => done(String(e)))")
        value = self.option("match.num_disparities").find_element("css selector", "input.value").get_attribute("value")
        self.assertRegex(text, rf"num_disparities: *{value}\b")
        config = pathlib.Path(self.folder.name) / "copied.yaml"
        config.write_text(text)
        subprocess.run([CAIRN, "segment", str(self.source / "0000"), "--config", str(config), "--json"], check=True, capture_output=True)

    def test_a_reason_blinks(self):
        self.look_at(self.live("--tunable"))
        self.pause()
        pink = 0xfff23dff  # of the canvas, little endian
        canvas = "[data-panel=disparity] canvas"
        self.assertNotIn(pink, self.colours(canvas))
        row = next(row for row in self.find_all(".reason") if "off" not in row.get_attribute("class").split())
        row.click()
        seen = {True: False, False: False}

        def both():
            seen[pink in self.colours(canvas)] = True
            return all(seen.values())
        self.wait_until(both, "it blinks")
        self.assertEqual(row.get_attribute("aria-pressed"), "true")
        self.keep("live_blinks")
        row.click()
        self.wait_until(lambda: pink not in self.colours(canvas), "it stops")

    def test_pauses_and_steps(self):
        self.look_at(self.live("--tunable"))
        self.pause()
        before = self.frame()["frame"]
        time.sleep(1)
        self.assertEqual(self.frame()["frame"], before)
        self.step()
        ActionChains(self.browser).send_keys(" ").perform()
        self.wait_until(lambda: self.frame()["frame"] > before + 2, "it goes on")

    def test_hidden_panels_are_not_subscribed(self):
        self.look_at(self.live("--tunable"))
        self.find("[data-panel=scene] .enlarge").click()
        time.sleep(1)
        before = self.drawn()
        time.sleep(2)
        self.assertLessEqual(self.drawn() - before, 1)
        self.keep("live_enlarged")
        self.find("[data-panel=scene] .enlarge").click()
        self.wait_until(lambda: self.drawn() > before + 3, "the image is back")

    def test_read_only(self):
        self.look_at(self.live())
        self.wait_until(lambda: self.find(".read-only").is_displayed(), "it is said")
        self.assertEqual(self.script("return document.querySelectorAll('.option :is(input, select):not(:disabled)').length"), 0)
        self.assertFalse(self.find("#pause").is_enabled())
        self.keep("live_read_only")

    def test_reconnects_to_a_restarted_server(self):
        self.may_fail_to_connect = True
        live = self.live("--tunable")
        self.look_at(live)
        at = live.address
        live.end()
        self.wait_until(lambda: self.find("#link").text == "server gone", "it is said")
        self.assertIn("No server for", self.find(".news").text)
        self.keep("live_gone")
        before = self.drawn()
        self.live("--tunable", at=at)
        self.wait_until(lambda: self.drawn() > before + 3, "it draws again")
        self.assertFalse(self.find(".news").is_displayed())

    def test_nothing_overlaps_at_any_size(self):
        self.look_at(self.live("--tunable"))
        size = self.browser.get_window_size()
        try:
            for width, height in ((1024, 768), (1366, 768), (1920, 1080), (700, 1000)):
                self.browser.set_window_size(width, height)
                time.sleep(0.5)
                wide, boxes = self.script(
                    "const seen = [...document.querySelectorAll('#bar, #desk > .panel, #desk > .card')].filter((n) => n.offsetParent);"
                    "return [document.documentElement.scrollWidth - innerWidth, seen.map((n) => { const b = n.getBoundingClientRect();"
                    "return [n.dataset.panel ?? n.id, b.left, b.top, b.right, b.bottom]; })]")
                self.assertLessEqual(wide, 0, width)
                for k, (name, left, top, right, bottom) in enumerate(boxes):
                    self.assertGreater(right - left, 150, f"{name} at {width}")
                    self.assertGreater(bottom - top, 40, f"{name} at {width}")
                    for other, *rest in boxes[k + 1:]:
                        apart = right <= rest[0] + 1 or rest[2] <= left + 1 or bottom <= rest[1] + 1 or rest[3] <= top + 1
                        self.assertTrue(apart, f"{name} and {other} at {width}")
                self.keep(f"live_{width}")
        finally:
            self.browser.set_window_size(size["width"], size["height"])


if __name__ == "__main__":
    if not re.search(r"live views.*yes", subprocess.run([CAIRN, "info"], capture_output=True, text=True).stdout):
        print("skipped: views are not built in (libboost-dev, libssl-dev)")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
