# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""page_in_browser.py CAIRN SOURCE_DIR: tests the pages of --html in headless Chromium. Sorts tables, moves the
slider, points at pixels, and compares the page with the result files. Exit code 77 (skipped) without Debian's
chromium, chromium-driver, python3-selenium or python3-pil. CAIRN_SCREENSHOTS=DIR keeps screenshots."""
import base64
import io
import json
import math
import pathlib
import shutil
import sys
import tempfile
import time
import unittest

from in_browser import HOSTILE, SOURCE, PageTest, browser, cairn
from PIL import Image, ImageChops, ImageStat
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.select import Select

REASONS = {1: "border", 2: "left-right", 4: "not unique", 8: "flat", 16: "no texture", 32: "below ground", 64: "speckle",
           128: "no data", 256: "sky", 512: "unlikely"}


class Page(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(cls.folder.name)
        cls.frames, cls.results = root / "frames", root / "results"
        for sample in ("dim_light", "four_in_a_row", "overlap"):
            shutil.copytree(SOURCE / "data" / "samples" / sample, cls.frames / sample)
        (cls.frames / "overlap").rename(cls.frames / HOSTILE)
        cls.names = sorted(path.name for path in cls.frames.iterdir())
        # One check more than in the preset, so that some pixels have two reasons.
        cairn("segment", cls.frames, "--html", "-o", cls.results, "--set", "uniqueness.ratio=5")
        cairn("evaluate", cls.results, cls.frames, "--html", root / "scores", "--json", root / "scores.json")
        cls.evaluation = json.loads((root / "scores.json").read_text())
        cls.pages = {"segment": cls.results / "segment.html", "evaluate": root / "scores" / "evaluation.html"}
        cls.browser = browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()
        cls.folder.cleanup()

    # ---- helpers ----

    def open(self, command):
        self.load(self.pages[command])

    def head(self, table, name):
        for cell in self.find_all(f"#{table} th"):
            if cell.text.split(" ↑")[0].split(" ↓")[0] == name:
                return cell
        self.fail(f"table {table} has no column {name}")

    def two_in_a_row(self):
        """Panels large enough to point at single pixels, and small enough for the window."""
        self.find("[data-columns='2']").click()

    def point_at(self, panel, x, y):
        """Moves the pointer to the middle of a pixel and returns the page's description of it."""
        stage = self.find(f"[data-panel={panel}] .stage")
        self.move_pointer(stage, (x + 0.5) / 320, (y + 0.5) / 240)
        tip = self.find("#tip")
        self.assertTrue(tip.is_displayed())
        return tip.text

    def result(self, index):
        folder = self.results / self.names[index]
        maps = {}
        for name in ("disparity", "reject", "objects", "confidence", "space"):
            with Image.open(folder / f"{name}.png") as image:
                maps[name] = image.copy()
        return maps, json.loads((folder / "objects.json").read_text())

    def legend(self, panel):
        """The chips of a panel's legend: name → per cent."""
        chips = [chip.text.rsplit(" %", 1)[0].rsplit("\n", 1) for chip in self.find_all(f"[data-panel={panel}] .chip")]
        return {name: float(share) for name, share in chips}

    # ---- tests ----

    def test_makes_no_network_requests(self):
        for command in self.pages:
            self.open(command)
            self.assertEqual(self.network_requests(), [])

    def test_has_all_images_and_tables(self):
        self.open("segment")
        panels = [panel.get_attribute("data-panel") for panel in self.find_all(".panel")]
        self.assertEqual(panels, ["left", "disparity", "regions", "objects", "space", "above"])
        self.assertEqual(len(self.find_all(".panel canvas")), 4)
        self.assertGreater(self.browser.execute_script("return document.querySelector('[data-panel=left] img').naturalWidth"), 0)
        _, document = self.result(0)
        self.assertEqual(self.column("objects", "id"), [str(o["id"]) for o in document["objects"]])
        self.assertEqual(self.column("objects", "distance m"), [f"{o['position_m'][2]:.2f}" for o in document["objects"]])
        self.assertEqual(self.column("objects", "interval m"),
                         [f"{near:.2f} – " + ("∞" if far is None else f"{far:.2f}") for near, far in
                          (o["depth_interval_m"] for o in document["objects"])])
        self.assertEqual(self.column("frames-table", "frame"), self.names)
        marks = [mark.text for mark in self.find_all("[data-panel=objects] .mark")]
        self.assertEqual(marks, [f"{o['id']}: {o['position_m'][2]:.2f} m" for o in document["objects"]])
        self.keep("segment")

    def test_obstacles_and_floor_equal_those_of_the_files(self):
        for command in self.pages:
            self.open(command)
            maps, _ = self.result(0)
            space, ids = list(maps["space"].getdata()), list(maps["objects"].getdata())
            shares = {name: 100 * sum(kinds) / len(space) for name, kinds in (
                ("obstacle: object", (s == 255 and i > 0 for s, i in zip(space, ids))),
                ("obstacle: no object", (s == 255 and i == 0 for s, i in zip(space, ids))),
                ("floor", (s == 128 for s in space)), ("sky", (s == 64 for s in space)),
                ("unknown", (s == 0 for s in space)))}
            self.assertGreater(min(share for name, share in shares.items() if name != "sky"), 0)
            shown = self.legend("space")
            self.assertEqual(list(shown), list(shares))
            for name, share in shares.items():
                self.assertAlmostEqual(shown[name], share, delta=0.051)
            Select(self.find("[data-panel=space] select")).select_by_visible_text("Floor")
            self.assertEqual(list(self.legend("space")), ["floor"])
            drawn = self.browser.execute_script(
                "const c = document.querySelector('[data-panel=space] canvas');"
                "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                "return Array.from({length: d.length / 4}, (_, i) => d[4 * i + 3] > 0);")
            self.assertEqual(drawn, [s == 128 for s in space])

    def test_obstacles_that_are_not_objects_are_listed_and_boxed(self):
        self.open("segment")
        _, document = self.result(0)
        listed = document["left_out"]
        self.assertGreater(len(listed), 1)
        self.assertEqual(self.column("left-out", "reason"), [left["reason"] for left in listed])
        self.assertEqual(self.column("left-out", "distance m"), [f"{left['position_m'][2]:.2f}" for left in listed])
        self.assertEqual(self.column("left-out", "area px"), [str(left["area"]) for left in listed])
        self.assertEqual(self.find_all(".box"), [])
        row = self.find("#left-out tr[data-key='1']")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", row)
        ActionChains(self.browser).move_to_element(row).perform()
        boxes = self.find_all(".stage .box")
        self.assertEqual(len(boxes), 5)
        for box in boxes:
            at = self.browser.execute_script(
                "const b = arguments[0].getBoundingClientRect(), s = arguments[0].parentElement.getBoundingClientRect();"
                "return [b.left - s.left, b.top - s.top, b.width, b.height].map((v) => v / s.width * 320);", box)
            for shown, expected in zip(at, listed[1]["bbox"]):
                self.assertAlmostEqual(shown, expected, delta=0.1)
        row.click()
        ActionChains(self.browser).move_to_element(self.find("h1")).perform()
        self.assertEqual(self.find("#left-out tr[data-key='1']").get_attribute("aria-selected"), "true")
        self.assertEqual(len(self.find_all(".stage .box")), 5)  # persists until the next click
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", row)
        row.click()
        ActionChains(self.browser).move_to_element(self.find("h1")).perform()
        self.assertEqual(self.find_all(".box"), [])

    def test_the_view_from_above_is_drawn_to_scale(self):
        self.open("segment")
        self.two_in_a_row()
        _, document = self.result(0)
        drawn = self.browser.execute_script(
            "const all = (s, f) => [...document.querySelectorAll('.above ' + s)].map(f);"
            "return {camera: all('.camera', (c) => c.getAttribute('d').slice(1).split('l')[0].split(',').map(Number))[0],"
            " rings: all('.ring', (r) => Number(r.getAttribute('d').split('A')[1].split(' ')[0])),"
            " labels: all('.ring + text', (t) => t.textContent),"
            " dots: all('.dot', (d) => [d.cx.baseVal.value, d.cy.baseVal.value]),"
            " boxes: Object.fromEntries(all('.thing', (g) => [g.dataset.key, [...g.querySelector('polygon').points].map((p) => [p.x, p.y])]))};")
        self.assertGreater(len(drawn["rings"]), 1)
        scale = drawn["rings"][0] / float(drawn["labels"][0].removesuffix(" m"))  # px of the drawing per metre
        for radius, label in zip(drawn["rings"], drawn["labels"]):
            self.assertAlmostEqual(radius, scale * float(label.removesuffix(" m")), delta=0.01)

        def in_drawing(forward, left):
            return drawn["camera"][0] - scale * left, drawn["camera"][1] - scale * forward

        def assert_there(shown, expected):
            for place, (x, y) in zip(shown, expected):
                self.assertAlmostEqual(place[0], x, delta=0.11)
                self.assertAlmostEqual(place[1], y, delta=0.11)
                self.assertTrue(0 <= x <= 480 and 0 <= y <= 360)

        scan = document["obstacle_scan"]
        angles = [scan["angle_min_rad"] + i * scan["angle_increment_rad"] for i in range(len(scan["ranges_m"]))]
        seen = [(r, a) for r, a in zip(scan["ranges_m"], angles) if r is not None]
        self.assertEqual(len(drawn["dots"]), len(seen))
        assert_there(drawn["dots"], [in_drawing(r * math.cos(a), r * math.sin(a)) for r, a in seen])
        self.assertEqual(set(drawn["boxes"]), {str(o["id"]) for o in document["objects"]})
        for found in document["objects"]:
            (x, y, _), (long, short, _), yaw = (found["box_on_floor"][key] for key in ("centre_m", "size_m", "yaw_rad"))
            corners = [in_drawing(x + a * long / 2 * math.cos(yaw) - b * short / 2 * math.sin(yaw),
                                  y + a * long / 2 * math.sin(yaw) + b * short / 2 * math.cos(yaw))
                       for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
            assert_there(drawn["boxes"][str(found["id"])], corners)
        # The position of the pixel under the pointer is ringed, and a box leads to its row.
        maps, _ = self.result(0)
        x, y = next((x, y) for y in range(120, 240) for x in range(320)
                    if maps["objects"].getpixel((x, y)) == 1 and maps["disparity"].getpixel((x, y)))
        self.point_at("objects", x, y)
        ring = self.browser.execute_script(
            "const r = document.querySelector('.above .here');"
            "return [r.getAttribute('visibility'), r.cx.baseVal.value, r.cy.baseVal.value]")
        self.assertEqual(ring[0], "visible")
        rig, matrix = document["rig"], document["floor_frame"]["floor_from_camera"]
        z = rig["focal_px"] * rig["baseline_m"] / (maps["disparity"].getpixel((x, y)) / 256 + rig["doffs_px"])
        place = (z * (x - rig["cx_px"]) / rig["focal_px"], z * (y - rig["cy_px"]) / rig["focal_px"], z, 1)
        expected = in_drawing(*(sum(a * b for a, b in zip(matrix[row:row + 4], place)) for row in (0, 4)))
        self.assertLess(math.dist(ring[1:], expected), 0.5)
        box = self.find(".above .thing[data-key='1'] polygon")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", box)
        ActionChains(self.browser).move_to_element(box).click().perform()
        self.assertEqual(self.find("#objects tr[data-key='1']").get_attribute("aria-selected"), "true")
        dim = [thing.get_attribute("data-key") for thing in self.find_all(".above .thing.dim")]
        self.assertEqual(sorted(dim), [str(o["id"]) for o in document["objects"] if o["id"] != 1])
        self.keep("from_above")

    def test_without_a_calibration_there_are_no_metres(self):
        folder, out = self.results.parent / "pair", self.results.parent / "uncalibrated"
        folder.mkdir()
        for side in ("left", "right"):
            shutil.copy(SOURCE / "data" / "samples" / "four_in_a_row" / f"{side}.png", folder)
        cairn("segment", folder, "--html", "-o", out)
        self.pages = {"segment": out / "segment.html"}
        self.open("segment")
        self.assertEqual([panel.get_attribute("data-panel") for panel in self.find_all(".panel")],
                         ["left", "disparity", "regions", "objects", "space"])
        heads = [head.text for head in self.find_all("#objects th")]
        self.assertIn("disparity px", heads)
        self.assertNotIn("interval m", heads)
        self.two_in_a_row()
        text = self.point_at("disparity", 160, 60)
        self.assertIn("disparity\n", text)
        self.assertIn("space\n", text)
        for words in ("depth z", "x, y\n", "above the floor"):
            self.assertNotIn(words, text)

    def test_the_right_image_is_shown_if_available(self):
        self.open("evaluate")
        self.assertEqual(self.find_all("[data-panel=left] select"), [])
        self.open("segment")
        self.two_in_a_row()
        Select(self.find("[data-panel=left] select")).select_by_visible_text("Right image")
        shown = Image.open(io.BytesIO(base64.b64decode(self.find("[data-panel=left] img").get_attribute("src").split(",")[1])))
        with Image.open(self.frames / self.names[0] / "right.png") as image:
            difference = ImageStat.Stat(ImageChops.difference(shown.convert("L"), image.convert("L"))).mean[0]
        self.assertLess(difference, 2)  # JPEG artefacts, and the conversion to grey
        # The ring is at the pixel in the right image, and leads back to the left one.
        maps, _ = self.result(0)
        disparity = maps["disparity"].load()
        x, y = next((x, y) for y in range(120, 240) for x in range(160, 320) if disparity[x, y])
        self.point_at("disparity", x, y)
        cross = self.find("[data-panel=left] .cross")
        right = float(cross.get_attribute("style").split("left: ")[1].split("%")[0]) * 320 / 100 - 0.5
        self.assertAlmostEqual(right, x - disparity[x, y] / 256, delta=0.02)
        text = self.point_at("left", round(right), y)
        back, row = (int(part.split(" ")[1]) for part in text.split("\n")[0].split(", "))
        self.assertEqual(row, y)
        self.assertAlmostEqual(back - disparity[back, row] / 256, round(right), delta=0.52)
        x, y = next((x, y) for y in range(120, 240) for x in range(160, 320) if not disparity[x, y])
        self.point_at("disparity", x, y)
        self.assertEqual(self.find_all("[data-panel=left] .cross"), [])
        self.keep("right_picture")

    def test_slider_buttons_and_arrows_change_the_frame(self):
        self.open("segment")
        self.assertEqual(self.name_shown(), self.names[0])
        first = self.find("[data-panel=left] img").get_attribute("src")
        self.find("#slider").send_keys(Keys.ARROW_RIGHT)
        self.wait_for_frame(1)
        self.assertEqual(self.name_shown(), self.names[1])
        self.assertNotEqual(self.find("[data-panel=left] img").get_attribute("src"), first)
        _, document = self.result(1)
        self.assertEqual(self.column("objects", "area px"), [str(o["area"]) for o in document["objects"]])
        self.find("#next").click()
        self.wait_for_frame(2)
        self.find("h1").click()
        body = self.find("body")
        body.send_keys(Keys.ARROW_LEFT)
        self.wait_for_frame(1)
        body.send_keys(Keys.END)
        self.wait_for_frame(2)
        body.send_keys(Keys.ARROW_RIGHT)  # already the last frame
        self.wait_for_frame(2)
        self.find("#previous").click()
        self.wait_for_frame(1)
        self.find(f"#frames-table tr[data-key='{self.names.index(HOSTILE)}']").click()
        self.wait_for_frame(self.names.index(HOSTILE))
        self.assertEqual(self.name_shown(), HOSTILE)

    def playing(self):
        return self.find("#play").get_attribute("aria-pressed") == "true"

    def test_plays_to_the_last_frame_and_stops(self):
        self.open("segment")
        self.browser.execute_script(
            "window.seen = []; new MutationObserver(() => seen.push(document.documentElement.dataset.shown))"
            ".observe(document.documentElement, {attributeFilter: ['data-shown']});")
        self.assertFalse(self.playing())
        self.find("#play").click()
        self.assertTrue(self.playing())
        self.wait_for_frame(2)
        self.assertEqual(self.browser.execute_script("return seen"), ["1", "2"])
        time.sleep(0.4)
        self.assertFalse(self.playing())
        # The space bar restarts at the end and pauses; selecting a frame pauses, too.
        body = self.find("body")
        body.send_keys(Keys.SPACE)
        self.wait_for_frame(0)
        body.send_keys(Keys.SPACE)
        self.assertFalse(self.playing())
        at = self.browser.execute_script("return seen.length")
        time.sleep(0.5)
        self.assertEqual(self.browser.execute_script("return seen.length"), at)
        self.assertEqual(self.browser.execute_script("return scrollY"), 0)
        body.send_keys(Keys.SPACE)
        self.assertTrue(self.playing())
        body.send_keys(Keys.HOME)
        self.assertFalse(self.playing())
        self.wait_for_frame(0)

    def test_tables_sort_both_ways(self):
        self.open("segment")
        for name in ("confidence", "distance m", "area px"):
            values = [float(text) for text in self.column("objects", name)]
            self.assertGreater(len(set(values)), 1)
            for order, way in (("ascending", 1), ("descending", -1)):
                self.head("objects", name).find_element(By.TAG_NAME, "button").click()
                self.assertEqual(self.head("objects", name).get_attribute("aria-sort"), order)
                shown = [float(text) for text in self.column("objects", name)]
                self.assertEqual(shown, sorted(values, reverse=way < 0))
        self.assertEqual(self.head("objects", "id").get_attribute("aria-sort"), "none")

    def test_pointing_at_a_pixel_shows_the_values_of_the_files(self):
        self.open("segment")
        self.two_in_a_row()
        maps, document = self.result(0)
        width, height = maps["reject"].size
        seen = {"hole": 0, "object": 0, "two reasons": 0}
        # Some of each kind: spread over the image, and the first pixels with two reasons.
        places = [(x, y) for y in range(7, height, 41) for x in range(5, width, 53)]
        bits = maps["reject"].load()
        places += [(x, y) for y in range(height) for x in range(width) if bin(bits[x, y]).count("1") > 1][:3]
        for x, y in places:
            text = self.point_at("disparity", x, y)
            self.assertIn(f"x {x}, y {y}", text)
            reject, value, object_id = (maps[name].getpixel((x, y)) for name in ("reject", "disparity", "objects"))
            if reject:
                seen["hole"] += 1
                line = next(line for line in text.split("\n") if line in
                            [", ".join(order) for order in orders([REASONS[bit] for bit in REASONS if reject & bit])])
                seen["two reasons"] += "," in line
            else:
                disparity = value / 256
                shown = float(text.split("disparity\n")[1].split(" px")[0])
                self.assertAlmostEqual(shown, disparity, delta=0.5 / 64 + 0.0051 + 0.5 / 256)
                rig = document["rig"]
                metres = float(text.split("depth z\n")[1].split(" m")[0])
                expected = rig["focal_px"] * rig["baseline_m"] / (disparity + rig["doffs_px"])
                self.assertAlmostEqual(metres, expected, delta=0.006 + expected * 0.011 / (disparity + rig["doffs_px"]))
                right, down = map(float, text.split("x, y\n")[1].split(" m")[0].split(", "))
                self.assertAlmostEqual(right, (x - rig["cx_px"]) * metres / rig["focal_px"], delta=0.011)
                self.assertAlmostEqual(down, (y - rig["cy_px"]) * metres / rig["focal_px"], delta=0.011)
                up = document["floor_frame"]["floor_from_camera"][8:12]
                self.assertAlmostEqual(float(text.split("above the floor\n")[1].split(" m")[0]),
                                       up[0] * right + up[1] * down + up[2] * metres + up[3], delta=0.021)
                self.assertIn(f"confidence\n{maps['confidence'].getpixel((x, y)) / 255:.2f}", text)
            space = maps["space"].getpixel((x, y))
            self.assertIn("space\n" + ("floor" if space == 128 else "sky" if space == 64 else "unknown" if space == 0 else
                                       "obstacle: object" if object_id else "obstacle: no object"), text)
            if object_id:
                seen["object"] += 1
                found = document["objects"][object_id - 1]
                block = text.split(f"object {object_id}\n")[1]
                self.assertIn(f"{found['position_m'][2]:.2f} m", block)
                self.assertIn(f"confidence\n{found['confidence']:.2f}", block)
            else:
                self.assertNotIn("\nobject ", text)
        self.assertGreater(seen["hole"], 3)
        self.assertGreater(seen["object"], 1)
        self.assertGreater(seen["two reasons"], 0)
        self.assertEqual(len(self.find_all(".cross")), 4)  # the same pixel in the other panels

    def test_a_click_highlights_an_object(self):
        self.open("segment")
        self.two_in_a_row()
        maps, _ = self.result(0)
        ids = maps["objects"].load()
        x, y = next((x, y) for y in range(240) for x in range(320) if ids[x, y] == 1)
        self.point_at("objects", x, y)
        self.assertIn("near", self.find("#objects tr[data-key='1']").get_attribute("class"))
        ActionChains(self.browser).click().perform()
        self.assertEqual(self.find("#objects tr[data-key='1']").get_attribute("aria-selected"), "true")
        dim = [mark.text.split(":")[0] for mark in self.find_all("[data-panel=objects] .mark.dim")]
        self.assertEqual(dim, [str(o["id"]) for o in self.result(0)[1]["objects"] if o["id"] != 1])

    def test_evaluation_shows_the_numbers_of_its_json(self):
        self.open("evaluate")
        panels = [panel.get_attribute("data-panel") for panel in self.find_all(".panel")]
        self.assertEqual(panels, ["left", "disparity", "truth", "objects", "space", "above"])
        summary = self.evaluation["summary"]["objects"]
        tiles = self.find("#tiles").text
        self.assertIn(f"{100 * summary['recall_50']:.1f} %", tiles)
        self.assertIn(f"{100 * summary['median_error']:.1f} %", tiles)
        true_ones = [score for frame in self.evaluation["frames"] for score in frame["objects"]["true"]]
        self.assertEqual(len(self.column("truth", "id")), len(true_ones))
        button = self.head("truth", "E %").find_element(By.TAG_NAME, "button")
        button.click()
        button.click()
        worst = max(true_ones, key=lambda score: float("inf") if score["error"] is None else score["error"])
        top = self.column("truth", "E %")[0]
        self.assertEqual(top, "missed" if worst["error"] is None else f"{100 * worst['error']:.1f}")
        chooser = Select(self.find("[data-panel=disparity] select"))
        for mode in ("Disparity error", "True disparity", "Confidence"):
            chooser.select_by_visible_text(mode)
            chooser = Select(self.find("[data-panel=disparity] select"))
            self.assertEqual(chooser.first_selected_option.text, mode)
        self.keep("evaluate")

    def test_histogram_counts_and_lists_the_true_objects(self):
        self.open("evaluate")
        true_ones = [score for frame in self.evaluation["frames"] for score in frame["objects"]["true"]]
        cap = self.evaluation["summary"]["objects"]["error_cap"]
        bins = [0] * 21
        for score in true_ones:
            error = cap if score["error"] is None else min(score["error"], cap)
            bins[min(20, int(error / cap * 20))] += 1
        bars = self.find_all("#histogram .hit")
        shown = [self.browser.execute_script("return arguments[0].textContent", bar) for bar in bars]
        self.assertEqual([int(text.split(": ")[1].split(" ")[0]) for text in shown], bins)
        fullest = bins.index(max(bins))
        ActionChains(self.browser).move_to_element(bars[fullest]).click().perform()
        self.assertEqual(len(self.column("truth", "id")), bins[fullest])
        ActionChains(self.browser).move_to_element(self.find_all("#histogram .hit")[fullest]).click().perform()
        self.assertEqual(len(self.column("truth", "id")), len(true_ones))

    def test_a_true_object_leads_to_its_frame(self):
        self.open("evaluate")
        last = len(self.names) - 1
        score = self.evaluation["frames"][last]["objects"]["true"][0]
        row = self.find(f"#truth tr[data-key='{last}:{score['id']}']")
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", row)
        row.click()
        self.wait_for_frame(last)
        self.assertEqual(self.find(f"#objects tr[data-key='{score['ours']}']").get_attribute("aria-selected"), "true")
        self.find("#truth").find_element(By.XPATH, "../..").find_element(By.TAG_NAME, "label").click()
        self.assertEqual(set(self.column("truth", "frame")), {self.names[last]})

    def test_light_and_dark_change_in_place(self):
        self.open("segment")
        colour = "return getComputedStyle(document.body).backgroundColor"
        before = self.browser.execute_script(colour)
        self.find("#theme").click()
        after = self.browser.execute_script(colour)
        self.assertNotEqual(before, after)
        self.keep("segment_other_theme")
        self.find("#theme").click()
        self.assertEqual(self.browser.execute_script(colour), before)

    def test_fits_a_laptop_without_scrolling_sideways(self):
        for command in self.pages:
            self.open(command)
            wide, seen = self.browser.execute_script("return [document.documentElement.scrollWidth, innerWidth]")
            self.assertLessEqual(wide, seen)


def orders(names):
    """Every order of a few words: the page may list the reasons in any order."""
    if len(names) < 2:
        return [names]
    return [[name, *rest] for name in names for rest in orders([other for other in names if other != name])]


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
