"""Checks that the published schema accepts every good-*.json of a folder and refuses every bad-*.json."""

import json
import sys
from pathlib import Path

import fastjsonschema

accepts = fastjsonschema.compile(json.loads(Path(sys.argv[1]).read_text()))
files = sorted(Path(sys.argv[2]).glob("*.json"))
assert len(files) > 10, files
for file in files:
    try:
        accepts(json.loads(file.read_text()))
        refused = None
    except fastjsonschema.JsonSchemaException as error:
        refused = error
    assert (refused is None) == file.name.startswith("good"), f"{file.name}: {refused}"
