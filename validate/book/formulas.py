"""Formulas set by KaTeX when the book is built: one process of node that reads and answers line by line.

sphinxcontrib-katex has a server of its own for this.  On a busy machine it may not be ready when it is first asked, and
it may outlive Sphinx.  This process ends with its input, that is, with Sphinx.
"""

import json
import subprocess
from functools import cache
from pathlib import Path

import sphinxcontrib.katex

PROGRAM = """
const katex = require(process.argv[1]);
require("readline").createInterface({input: process.stdin}).on("line", line => {
  const [formula, options] = JSON.parse(line);
  process.stdout.write(JSON.stringify(katex.renderToString(formula, options)) + "\\n");
});
"""


@cache
def process():
    program = Path(sphinxcontrib.katex.__file__).with_name("katex.min.js")
    return subprocess.Popen(["node", "-e", PROGRAM, str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            encoding="utf-8")


def rendered(formula, options=None):
    """Return a formula in TeX as HTML; a wrong one is shown in red and has the class katex-error."""
    node = process()
    node.stdin.write(json.dumps([formula, {"throwOnError": False, **(options or {})}]) + "\n")
    node.stdin.flush()
    line = node.stdout.readline()
    if not line:
        raise RuntimeError(f"node ended at the formula {formula!r}")
    return json.loads(line)
