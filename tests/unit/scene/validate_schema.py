# SPDX-License-Identifier: Apache-2.0
"""validate_schema.py SCHEMA GOOD_FOLDER BAD_FOLDER: every scene of one folder must fit, none of the other."""
import json
import pathlib
import sys

import jsonschema

schema = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
validator = getattr(jsonschema, "Draft202012Validator", jsonschema.Draft7Validator)
validator.check_schema(schema)
failures = 0
for folder, should_fit in ((sys.argv[2], True), (sys.argv[3], False)):
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        errors = list(validator(schema).iter_errors(json.loads(path.read_text(encoding="utf-8"))))
        if bool(errors) == should_fit:
            failures += 1
            print(path, errors[0].message if errors else "should not fit the schema")
sys.exit(failures > 0)
