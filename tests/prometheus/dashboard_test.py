"""Every query of docker/grafana/maploc.json is one that Prometheus understands.

environment: MAPLOC_SOURCE_DIR
"""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

DASHBOARD = pathlib.Path(os.environ["MAPLOC_SOURCE_DIR"]) / "docker" / "grafana" / "maploc.json"


class Dashboard(unittest.TestCase):
    def test_every_query_is_one(self):
        panels = json.loads(DASHBOARD.read_text(encoding="utf-8"))["panels"]
        queries = [target["expr"] for panel in panels for target in panel["targets"]]
        self.assertGreater(len(queries), 20)
        rules = [{"record": f"query:{i}", "expr": query.replace("$__rate_interval", "1m")}
                 for i, query in enumerate(queries)]
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:  # JSON is YAML
            json.dump({"groups": [{"name": "dashboard", "rules": rules}]}, file)
            file.flush()
            check = subprocess.run(["promtool", "check", "rules", file.name], text=True, capture_output=True, check=False)
        self.assertEqual(check.returncode, 0, check.stdout + check.stderr)
        self.assertIn(f"{len(queries)} rules found", check.stdout)


if __name__ == "__main__":
    unittest.main()
