# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""batch_schema.py CAIRN SOURCE_DIR: checks that the rows of a batch run match docs/schema/batch_row.schema.json, and
that broken rows do not. Exit code 77 (skipped) without python3-jsonschema."""
import copy
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("skipped: no python3-jsonschema")
    sys.exit(77)

cairn, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
# A single document: python3-jsonschema of Debian 12 does not follow references between URNs.
whole = (source / "docs/schema/objects.schema.json").read_text().replace('"#/$defs/', '"#/$defs/document/$defs/')
published = json.loads((source / "docs/schema/batch_row.schema.json").read_text().replace("urn:cairn:objects:1#", "#/$defs/document"))
published["$defs"] = {"document": {key: part for key, part in json.loads(whole).items() if key in ("properties", "$defs")}}
validator = jsonschema.Draft202012Validator
validator.check_schema(published)
open_form, closed_form = validator(published), validator({**published, "additionalProperties": False})

with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    shutil.copytree(source / "data/samples/four_in_a_row", folder / "in/good")
    shutil.copytree(source / "data/samples/four_in_a_row", folder / "in/unmeasured", ignore=lambda *_: ["calib.txt"])
    shutil.copytree(source / "data/samples/four_in_a_row", folder / "in/broken")
    (folder / "in/broken/right.png").write_bytes(b"no image")
    for words in ("plan in -o run", "work run", "merge run -o rows.jsonl"):
        subprocess.run([cairn, "batch", *words.split()], cwd=folder, check=True, capture_output=True)
    rows = [json.loads(line) for line in (folder / "rows.jsonl").read_text().splitlines()]

failures = 0


def expect(fine, words):
    global failures
    if not fine:
        print(words)
        failures += 1


by_name = {row["frame"]: row for row in rows}
expect(sorted(by_name) == ["broken", "good", "unmeasured"], f"other frames: {list(by_name)}")
for row in rows:
    for error in closed_form.iter_errors(row):
        expect(False, f"{row['frame']}: {error.json_path}: {error.message[:200]}")
good, broken = by_name["good"], by_name["broken"]
expect(good["objects"] and good["rig"] and good["obstacle_scan"], "the good frame shows too little to test the form")
expect("error" in broken and len(broken) == 2, "the broken frame is no error row")

count = 0
for key in good:
    without = copy.deepcopy(good)
    del without[key]
    other = {**good, key: [[True]]}
    for name, row in ((f"without {key}", without), (f"another type of {key}", other)):
        count += 1
        expect(not open_form.is_valid(row), f"passed, though broken: {name}")
for name, row in (("error beside objects", {**good, "error": "why"}), ("an empty error", {**broken, "error": ""})):
    count += 1
    expect(not open_form.is_valid(row), f"passed, though broken: {name}")
expect(open_form.is_valid({**good, "later": 1}), "a later key is refused")
expect(open_form.is_valid({**good, "stamp_ns": 12}), "a stamp is refused")

print(f"{len(rows)} rows, {count} broken ones")
sys.exit(1 if failures else 0)
