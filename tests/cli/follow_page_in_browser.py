# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""follow_page_in_browser.py CAIRN SOURCE_DIR: tests the player of `cairn follow --html` in headless Chromium. Plays,
scrubs, points, and compares the page with the result files; measures the time to draw a frame out of 1,000. Skipped
under the conditions in in_browser.py. CAIRN_SCREENSHOTS=DIR keeps screenshots."""
import json
import math
import pathlib
import re
import shutil
import sys
import tempfile
import time
import unittest

from in_browser import HOSTILE, SOURCE, PageTest, browser, cairn
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

BLOCK = re.compile(r'<script type="application/json" id="([^"]+)">(.*?)</script>\n', re.DOTALL)
FRAMES = 8
LONG = 1000

SCRUB = """
const done = arguments[0], slider = document.getElementById('slider'), count = Number(slider.max) + 1;
const soon = () => new Promise((then) => { const c = new MessageChannel(); c.port1.onmessage = then; c.port2.postMessage(0); });
(async () => {
  const times = [];
  for (let i = 1; i <= 200; ++i) {
    const to = i * 617 % count, begin = performance.now();
    slider.value = to;
    slider.dispatchEvent(new Event('input'));
    while (document.documentElement.dataset.shown !== String(to)) await soon();
    times.push(performance.now() - begin);
  }
  done(times);
})();
"""


def blocks_of(page):
    return {name: json.loads(text) for name, text in BLOCK.findall(page)}


def with_blocks(page, blocks):
    """The page with other data."""
    first, last = page.index('<script type="application/json"'), page.rindex("<script>\n")
    data = "".join(f'<script type="application/json" id="{name}">' + json.dumps(value).replace("<", "\\u003c") + "</script>\n"
                   for name, value in blocks.items())
    return page[:first] + data + page[last:]


def with_happenings(page):
    """Adds what the run of a static rig in a static scene lacks: refusals, a lost position, motion, events,
    landmarks."""
    blocks = blocks_of(page)
    for k in range(FRAMES):
        facts = blocks[f"facts-{k}"]
        if k in (2, 3):
            facts["motion"]["refusal"] = "few_points"
        if k == 4:
            facts["pose"] = None
        else:
            facts["pose"]["position_m"] = [0.25 * k, 0.5 if k > 4 else 0, 1]
        if facts["tracks"]:
            facts["tracks"][0]["moving"] = k in (5, 6)
            facts["tracks"][0]["velocity_m_s"] = [0, 0.5, 0]
            facts["tracks"][0]["position_m"][1] += 0.2 * k
        facts["reliability"] = 0.9 - 0.05 * k
    track = blocks[f"facts-{FRAMES - 1}"]["tracks"][0]["id"]
    blocks["happened"] = [
        {"frame": 3, "kind": "moved", "track": track, "landmark": 9, "from_m": [1, 1, 0], "to_m": [1, 2.5, 0], "probability": 0.97},
        {"frame": 6, "kind": HOSTILE, "track": track}]
    blocks["run"]["landmarks"] = [{"id": 9, "position_m": [2, 1, 0], "gone": False},
                                  {"id": 10, "name": "bin", "position_m": [1, 0, 0], "gone": True}]
    for k in (5, 6):
        blocks[f"facts-{k}"]["tracks"][-1]["landmark"] = 10
    return with_blocks(page, blocks)


def repeated(page, count):
    blocks = blocks_of(page)
    frames = [(blocks.pop(f"facts-{k}"), blocks.pop(f"maps-{k}")) for k in range(FRAMES)]
    for k in range(count):
        facts, maps = frames[k % FRAMES]
        blocks[f"facts-{k}"] = {**facts, "frame": k, "stamp_ns": k * 100_000_000}
        blocks[f"maps-{k}"] = maps
    blocks["run"]["frames"] = count
    return with_blocks(page, blocks)


class Player(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(cls.folder.name)
        source = root / "drive"
        for k in range(FRAMES - 1):
            shutil.copytree(SOURCE / "data" / "samples" / "four_in_a_row", source / f"{k:03}")
        shutil.copytree(SOURCE / "data" / "samples" / "four_in_a_row", source / HOSTILE)
        cairn("follow", source, "--rate", "10", "--html", "-o", root / "result")
        cls.plain = root / "result" / "follow.html"
        page = cls.plain.read_text()
        cls.rich, cls.long, cls.no_rig = root / "rich.html", root / "long.html", root / "no_rig.html"
        cls.rich.write_text(with_happenings(page))
        cls.long.write_text(repeated(page, LONG))
        for frame in source.iterdir():
            (frame / "calib.txt").unlink()
        cairn("follow", source, "--rate", "10", "--html", "-o", root / "no_rig")
        (root / "no_rig" / "follow.html").rename(cls.no_rig)
        cls.lines = [json.loads(line) for line in (root / "result" / "tracks.jsonl").read_text().splitlines()]
        cls.browser = browser()
        cls.browser.set_script_timeout(120)

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()
        cls.folder.cleanup()

    # ---- helpers ----

    def go(self, index):
        self.browser.execute_script(
            "const s = document.getElementById('slider'); s.value = arguments[0]; s.dispatchEvent(new Event('input'))", index)
        self.wait_for_frame(index)

    def press(self, key):
        ActionChains(self.browser).send_keys(key).perform()

    def click_there(self):
        """A click where the pointer is."""
        ActionChains(self.browser).click().perform()

    def seen(self, index):
        return [t for t in self.lines[index]["tracks"] if t["object"] and t["state"] != "tentative"]

    def drawn_from_above(self):
        """The drawing's px per metre, and in px the map's origin, the camera, and each track's dot."""
        return self.browser.execute_script(
            "const d = document.querySelector('.above'), c = (n) => [n.cx.baseVal.value, n.cy.baseVal.value];"
            "const step = Number(document.querySelector('[data-panel=above] .count').textContent.match(/[\\d.]+/)[0]);"
            "const rows = [...d.querySelector('.grid').getAttribute('d').matchAll(/M0 ([\\d.-]+)/g)].map((m) => Number(m[1]));"
            "const o = d.querySelector('.origin').getAttribute('d').match(/M([\\d.-]+) ([\\d.-]+)/);"
            "return {metre: (rows[0] - rows[1]) / step, origin: [Number(o[1]) + 5, Number(o[2])], camera: c(d.querySelector('.eye')),"
            " camera_shown: d.querySelector('.eye').getAttribute('visibility'),"
            " tracks: Object.fromEntries([...d.querySelectorAll('.track')].map((g) => [g.dataset.key, c(g.querySelector('.dot'))]))}")

    def pixels(self, selector):
        """For each pixel of a canvas its red, green, blue and alpha."""
        return self.browser.execute_script(
            "const c = document.querySelector(arguments[0]), copy = document.createElement('canvas');"
            "[copy.width, copy.height] = [c.width, c.height];"
            "const g = copy.getContext('2d', {willReadFrequently: true});"
            "g.drawImage(c, 0, 0);"
            "return [...new Uint32Array(g.getImageData(0, 0, c.width, c.height).data.buffer)]", selector)

    # ---- tests ----

    def test_makes_no_network_requests(self):
        self.load(self.rich)
        self.assertEqual(self.network_requests(), [])

    def test_shows_ids_distances_and_the_table_of_the_frame(self):
        self.load(self.plain)
        self.go(5)
        seen = self.seen(5)
        self.assertGreater(len(seen), 0)
        marks = {mark.get_attribute("textContent") for mark in self.find_all(".mark")}
        self.assertEqual({mark.split(":")[0] for mark in marks}, {str(t["id"]) for t in seen})
        listed = self.lines[5]["tracks"]
        self.assertEqual(self.column("tracks", "id"), [str(t["id"]) for t in listed])
        self.assertEqual(self.column("tracks", "x m"), [f"{t['position_m'][0]:.2f}" for t in listed])
        pose = self.lines[5]["pose"]
        x, y, z, w = pose["quaternion_xyzw"]
        axis = (2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y))  # camera axis in the map
        depths = [sum(a * (p - c) for a, p, c in zip(axis, t["position_m"], pose["position_m"])) for t in listed]
        for shown, depth in zip(self.column("tracks", "distance m"), depths):
            self.assertAlmostEqual(float(shown), depth, delta=0.006)
        self.assertLessEqual({f"{t['id']}: {shown} m" for t, shown in zip(listed, self.column("tracks", "distance m"))
                              if t in seen}, marks)
        self.keep("follow")

    def test_masks_equal_those_of_the_file(self):
        self.load(self.plain)
        self.go(6)
        labels = self.pixels(".screen canvas:nth-of-type(2)")
        where = [value >> 24 > 100 for value in labels]
        self.assertEqual(sum(where), sum(t["area"] for t in self.areas(6)))

    def areas(self, index):
        """Pixels of each confirmed track in view, counted from its run lengths."""
        result = []
        for track in self.seen(index):
            # COCO encoding: 5 bits per character, from the third run on as differences to the run before the previous
            # one.
            runs, text, at = [], track["rle"]["counts"], 0
            while at < len(text):
                value, shift, more = 0, 0, True
                while more:
                    c = ord(text[at]) - 48
                    value |= (c & 31) << shift
                    more, shift, at = bool(c & 32), shift + 5, at + 1
                    if not more and c & 16:
                        value |= -1 << shift
                runs.append(value + (runs[-2] if len(runs) > 2 else 0))
            result.append({"id": track["id"], "area": sum(runs[1::2])})
        return result

    def test_slider_buttons_and_keys_change_the_frame(self):
        self.load(self.plain)
        self.assertEqual(self.name_shown(), "000")
        self.find("#next").click()
        self.wait_for_frame(1)
        self.press(Keys.ARROW_RIGHT)
        self.wait_for_frame(2)
        self.press(Keys.ARROW_LEFT)
        self.wait_for_frame(1)
        self.press(Keys.END)
        self.wait_for_frame(FRAMES - 1)
        self.assertEqual(self.name_shown(), HOSTILE)
        self.assertFalse(self.find("#next").is_enabled())
        self.press(Keys.HOME)
        self.wait_for_frame(0)
        ActionChains(self.browser).key_down(Keys.SHIFT).send_keys(Keys.ARROW_RIGHT).key_up(Keys.SHIFT).perform()
        self.wait_for_frame(FRAMES - 1)
        # A click on the timeline selects the frame drawn there.
        self.move_pointer(self.find("#strip"), 0.5, 0.5)
        self.assertIn(f"/ {FRAMES}", self.find("#tip").text)
        self.click_there()
        shown = int(self.browser.execute_script("return document.getElementById('slider').value"))
        self.assertIn(shown, (3, 4))
        self.wait_for_frame(shown)  # wait until it is decoded
        time.sleep(0.3)
        self.assertEqual(self.browser.execute_script("return location.hash"), f"#{shown + 1}")

    def test_plays_at_the_sequences_rate_and_stops(self):
        self.load(self.plain)
        begin = time.time()
        self.press(Keys.SPACE)
        self.assertEqual(self.find("#play").get_attribute("aria-pressed"), "true")
        self.wait_for_frame(FRAMES - 1)
        self.assertGreater(time.time() - begin, 0.5)  # 0.7 s of a sequence of 10 Hz
        time.sleep(0.1)
        self.assertEqual(self.find("#play").get_attribute("aria-pressed"), "false")
        self.press("+")
        self.assertEqual(self.browser.execute_script("return document.getElementById('speed').value"), "2×")

    def test_events_are_listed_and_lead_to_their_frames(self):
        self.load(self.rich)
        texts = self.column("events", "event")
        self.assertEqual(len(texts), 2 + sum(text.endswith("is new") or " is new at " in text or "to move" in text or " stops" in text
                                             for text in texts) + 2)
        moved = next(k for k, text in enumerate(texts) if "was moved by 1.50 m" in text)
        self.assertIn("landmark 9", texts[moved])
        self.assertTrue(any(HOSTILE in text for text in texts))
        self.assertIn("motion refused: few points, 2 frames", texts)
        self.assertIn("camera position unknown", texts)
        rows = self.find_all("#events tbody tr")
        rows[moved].click()
        self.wait_for_frame(3)
        self.assertIn("now", rows[moved].get_attribute("class"))
        self.assertEqual(len(self.find_all(".above .moved")), 1)
        self.assertEqual(len(self.find_all("#tracks tr[aria-selected=true]")), 1)
        self.press("e")
        self.wait_for_frame(4)
        ActionChains(self.browser).key_down(Keys.SHIFT).send_keys("e").key_up(Keys.SHIFT).perform()
        self.wait_for_frame(3)
        self.go(0)
        self.assertEqual(len(self.find_all(".above .moved")), 0)
        self.keep("follow_events")

    def test_without_event_lines_events_come_from_the_tracks(self):
        self.load(self.plain)
        new = [text for text in self.column("events", "event") if "is new" in text]
        ids = {t["id"] for line in self.lines for t in line["tracks"] if t["state"] != "tentative"}
        self.assertEqual({int(text.split()[1]) for text in new}, ids)

    def test_the_view_from_above_is_drawn_to_scale(self):
        self.load(self.rich)
        self.go(6)
        drawn = self.drawn_from_above()
        tracks = {str(t["id"]): t["position_m"] for t in blocks_of(self.rich.read_text())["facts-6"]["tracks"]}
        self.assertEqual(set(drawn["tracks"]), set(tracks))

        def assert_at(shown, place):
            self.assertAlmostEqual(shown[0], drawn["origin"][0] - drawn["metre"] * place[1], delta=0.6)
            self.assertAlmostEqual(shown[1], drawn["origin"][1] - drawn["metre"] * place[0], delta=0.6)

        for key, place in tracks.items():
            assert_at(drawn["tracks"][key], place)
        assert_at(drawn["camera"], [1.5, 0.5])
        # Nothing is drawn while the position is unknown; a landmark is drawn from its first frame on.
        self.go(4)
        self.assertEqual(self.drawn_from_above()["camera_shown"], "hidden")
        shown = "return [...document.querySelectorAll('.landmark')].map((l) => l.getAttribute('visibility'))"
        self.assertEqual(self.browser.execute_script(shown), ["visible", "hidden"])
        self.go(5)
        self.assertEqual(self.browser.execute_script(shown), ["visible", "visible"])
        before = drawn["metre"]
        self.find("[title='Nearer']").click()
        self.assertAlmostEqual(self.drawn_from_above()["metre"] / before, 1.4, delta=0.02)
        self.find("[title='The whole run']").click()
        self.assertAlmostEqual(self.drawn_from_above()["metre"] / before, 1, delta=0.02)

    def test_pointing_at_an_object_marks_it_everywhere(self):
        self.load(self.plain)
        self.go(6)
        mark = blocks_of(self.plain.read_text())["facts-6"]["marks"][0]
        track = self.lines[6]["tracks"][mark["id"] - 1]["id"]
        self.move_pointer(self.find(".screen"), (mark["x"] + 0.5) / 320, (mark["y"] + 0.5) / 240)
        self.assertIn(f"track {track}", self.find("#tip").text)
        self.assertIn("near", self.find(f"#tracks tr[data-key='{track}']").get_attribute("class"))
        self.assertIn("chosen", self.find(f".above .track[data-key='{track}']").get_attribute("class"))
        self.click_there()
        self.assertEqual(self.find(f"#tracks tr[data-key='{track}']").get_attribute("aria-selected"), "true")
        self.go(5)  # the choice persists
        self.assertIn("chosen", self.find(f".above .track[data-key='{track}']").get_attribute("class"))
        self.press(Keys.ESCAPE)
        self.assertEqual(self.find_all("#tracks tr[aria-selected=true]"), [])
        row = self.find(f"#tracks tr[data-key='{track}']")
        ActionChains(self.browser).move_to_element(row).perform()
        self.assertIn("chosen", self.find(f".above .track[data-key='{track}']").get_attribute("class"))

    def test_the_curve_and_the_overlay_can_be_chosen(self):
        self.load(self.rich)
        names = [option.text for option in self.find_all("#curve option")]
        self.assertEqual(names, ["reliability", "inlier share", "tracks in view", "ms per frame"])
        before = self.pixels("#strip canvas")
        self.find_all("#curve option")[2].click()
        self.assertNotEqual(self.pixels("#strip canvas"), before)
        self.find("h1").click()  # keys control the player again
        self.go(6)
        self.assertGreater(len(self.find_all(".mark")), 0)
        tinted = sum(value >> 24 > 100 for value in self.pixels(".screen canvas:nth-of-type(2)"))
        self.press("m")
        outlined = sum(value >> 24 > 100 for value in self.pixels(".screen canvas:nth-of-type(2)"))
        self.assertTrue(0 < outlined < tinted)
        self.press("m")
        self.assertEqual(self.find_all(".mark"), [])

    def test_light_and_dark_theme_and_a_phone(self):
        self.load(self.rich)
        self.go(6)
        colour = "return getComputedStyle(document.body).backgroundColor"
        light = self.browser.execute_script(colour)
        self.find("#theme").click()
        self.assertNotEqual(self.browser.execute_script(colour), light)
        self.keep("follow_dark")
        size = self.browser.get_window_size()
        try:
            self.browser.set_window_size(500, 900)
            self.go(5)
            self.assertLessEqual(self.browser.execute_script("return document.documentElement.scrollWidth - innerWidth"), 0)
            self.keep("follow_phone")
        finally:
            self.browser.set_window_size(size["width"], size["height"])

    def test_without_a_calibration_there_are_ids_but_no_metres(self):
        self.load(self.no_rig)
        self.go(6)
        self.assertGreater(len(self.find_all(".mark")), 0)
        for mark in self.find_all(".mark"):
            self.assertRegex(mark.text, r"^\d+$")
        self.assertIn("no calibration", self.find("[data-panel=above] .stage").text)
        heads = [head.text for head in self.find_all("#tracks th")]
        self.assertNotIn("distance m", heads)
        self.assertFalse(any("refused" in text for text in self.column("events", "event")))

    def test_scrubs_through_a_thousand_frames(self):
        begin = time.time()
        self.load(self.long)
        opened = time.time() - begin
        times = sorted(self.browser.execute_async_script(SCRUB))
        median, p95 = times[len(times) // 2], times[math.ceil(0.95 * len(times)) - 1]
        print(f"{LONG} frames, {self.long.stat().st_size / 1e6:.1f} MB: open {opened:.2f} s, a frame is drawn within "
              f"{median:.1f} ms (median), {p95:.1f} ms (95 %)")
        self.assertLess(p95, 250)  # the target is 50 ms on an idle machine; tests may run on a busy one


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
