# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""objects_schema.py CAIRN SOURCE_DIR: checks that the command's output matches docs/schema/objects.schema.json, and
that broken documents do not. Exit code 77 (skipped) without python3-jsonschema."""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("skipped: no python3-jsonschema")
    sys.exit(77)

cairn, source = sys.argv[1], pathlib.Path(sys.argv[2])
published = json.loads((source / "docs/schema/objects.schema.json").read_text())


def strict(schema):
    """The schema without unknown keys and with all keys required: it is open for readers, not for the writer."""
    if isinstance(schema, list):
        return [strict(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    closed = {key: strict(part) for key, part in schema.items()}
    if schema.get("type") == "object" and "required" in schema:
        closed["additionalProperties"] = False
        closed["required"] = list(schema["properties"])
    return closed


validator = jsonschema.Draft202012Validator
validator.check_schema(published)
open_form, closed_form = validator(published), validator(strict(published))


def written(*arguments):
    run = subprocess.run([cairn, "segment", *map(str, arguments), "--json"], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


def documents():
    samples = sorted(path for path in (source / "data" / "samples").iterdir() if path.is_dir())
    assert samples, "no samples"
    for folder in samples:
        for preset in ("default", "paper"):
            yield f"{folder.name}, {preset}", written(folder, "--preset", preset)
    folder = samples[0]
    yield "given disparity", written(folder, "--disparity", folder / "disp_left.png")
    with tempfile.TemporaryDirectory() as lonely:
        calib = pathlib.Path(lonely) / "mounted.txt"
        calib.write_text((folder / "calib.txt").read_text() +
                         "\nground_points=10,200,4,200;300,210,293,210;20,230,12,230;280,190,275,190\n")
        yield "no correction, given ground", written(
            folder, "--calib", calib, "--set", "epipolar_correction.max_rows=-1", "--set", "ground.source=points")
        for name in ("left.png", "right.png"):
            (pathlib.Path(lonely) / name).write_bytes((folder / name).read_bytes())
        yield "no calibration", written(lonely)
        yield "no ground", written(lonely, "--set", "ground.source=off")


failures = 0


def expect(fine, words):
    global failures
    if not fine:
        print(words)
        failures += 1


checked = []
for name, document in documents():
    for error in closed_form.iter_errors(document):
        expect(False, f"{name}: {error.json_path}: {error.message[:200]}")
    checked.append(document)
full = max(checked, key=lambda document: len(document["objects"]))
expect(full["objects"] and full["rig"] and full["ground"]["plane"], "no sample with objects, calibration and ground")
expect(any(document["rig"] is None for document in checked), "no document without a calibration")
expect(any(document["external_disparity"] for document in checked), "no document of a given disparity")


def every_key(node, path=()):
    """The path of every key that the schema requires."""
    if isinstance(node, list):
        if node and isinstance(node[0], dict):
            yield from every_key(node[0], (*path, 0))
        return
    for key, value in node.items():
        yield (*path, key)
        if isinstance(value, (dict, list)) and key not in ("config", "timings_ms"):
            yield from every_key(value, (*path, key))


def at(document, path):
    for key in path:
        document = document[key]
    return document


def broken_documents():
    for path in every_key(full):
        without = copy.deepcopy(full)
        del at(without, path[:-1])[path[-1]]
        yield f"without {path}", without
        other = copy.deepcopy(full)
        at(other, path[:-1])[path[-1]] = [[True]]
        yield f"another type of {path}", other
    for path, value in [
            (("schema",), "1.0"), (("image", "width"), 0), (("rig", "baseline_m"), -0.1), (("objects", 0, "id"), 0),
            (("objects", 0, "confidence"), 1.5), (("objects", 0, "bbox"), [1, 2, 3]), (("objects", 0, "bbox"), [1, 2, 3, 4, 5]),
            (("objects", 0, "segmentation", "counts"), "a b"), (("objects", 0, "mean_colour"), [0, 0, 256]),
            (("ground", "refusal"), "no plane"), (("ground", "plane"), None), (("timings_ms", "match"), -1)]:
        other = copy.deepcopy(full)
        at(other, path[:-1])[path[-1]] = value
        yield f"{path} = {value}", other


count = 0
for name, document in broken_documents():
    count += 1
    expect(not open_form.is_valid(document), f"passed, though broken: {name}")
later = copy.deepcopy(full)
later["schema"], later["objects"][0]["later"] = "2.7", 1
expect(open_form.is_valid(later), "a later 2.x with one more key is refused")
expect(not closed_form.is_valid(later), "an unknown key would go unseen")

print(f"{len(checked)} documents, {count} broken ones")
sys.exit(1 if failures else 0)
