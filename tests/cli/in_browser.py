# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Shared by the tests of pages: headless Chromium, and helpers to inspect a page. Importing it exits with 77
(skipped) without Debian's chromium, chromium-driver, python3-selenium or python3-pil."""
import os
import pathlib
import shutil
import subprocess
import sys
import time
import unittest

try:
    import PIL  # noqa: F401
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.actions.action_builder import ActionBuilder
    from selenium.webdriver.common.by import By
except ImportError as missing:
    print(f"skipped: no {missing.name}")
    sys.exit(77)
for program in ("chromium", "chromedriver"):
    if not shutil.which(program):
        print(f"skipped: no {program}")
        sys.exit(77)

CAIRN, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
HOSTILE = "<!--<script> & \"x\""  # a name that must be escaped


def cairn(*arguments):
    subprocess.run([CAIRN, *map(str, arguments)], check=True, capture_output=True)


def browser(*more_arguments):
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    # No sandbox: as root, Chromium does not start with one, and the page is our own.
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1366,1000",
                     *more_arguments):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


class PageTest(unittest.TestCase):
    """A test of pages in `self.browser`; fails if the console has errors."""

    def tearDown(self):
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser")], [])

    def load(self, path, frame=0):
        self.browser.get("about:blank")
        self.browser.get(pathlib.Path(path).as_uri())
        self.wait_for_frame(frame)

    def wait_for_frame(self, index):
        for _ in range(200):
            if self.browser.execute_script("return document.documentElement.dataset.shown") == str(index):
                return
            time.sleep(0.025)
        self.fail(f"frame {index} is not shown")

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def find_all(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def name_shown(self):
        return self.browser.execute_script("return document.querySelector('#frame-name').firstChild.textContent")

    def column(self, table, name):
        """The texts of a column, top to bottom."""
        return self.browser.execute_script(
            "const t = document.getElementById(arguments[0]);"
            "const c = [...t.tHead.rows[0].cells].findIndex((h) => h.textContent === arguments[1]);"
            "return [...t.tBodies[0].rows].map((r) => r.cells[c].textContent);", table, name)

    def move_pointer(self, element, right, down):
        """Moves the pointer to the point at these shares of an element's width and height."""
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
        left, top, wide, high = self.browser.execute_script(
            "const b = arguments[0].getBoundingClientRect(); return [b.left, b.top, b.width, b.height]", element)
        mouse = ActionBuilder(self.browser, duration=0)  # in the window's own px: an element's middle is rounded
        mouse.pointer_action.move_to_location(round(left + right * wide), round(top + down * high))
        mouse.perform()

    def network_requests(self):
        names = self.browser.execute_script("return performance.getEntriesByType('resource').map((e) => e.name)")
        return [name for name in names if not name.startswith("data:")]

    def keep(self, name):
        if folder := os.environ.get("CAIRN_SCREENSHOTS"):
            self.browser.save_screenshot(str(pathlib.Path(folder) / f"{name}.png"))
