"""Runs what README.md shows, in order, in one fresh directory: commands in a shell, snippets in one Python, its scene.

``python tests/readme.py`` does all of it. With ``--installed`` the lines that make and fill the environment and run the
tests are left out, for a visviva that is installed already: that of the Python which runs this.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
INSTALLS = re.compile(r"pip install|activate")
HEADER = 'set -e; visviva() { "$PYTHON" -m visviva "$@"; }; cd "$1"\n'


def blocks(text: str) -> Iterator[tuple[str, str]]:
    """Language and text of every block of code."""
    for match in re.finditer(r"^```(\w+)\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL):
        yield match[1], match[2]


def script(kind: str, body: str, n: int, installed: bool) -> str:
    """What a block means to a shell; snippets of Python go on where the last one ended."""
    if kind == "sh":
        lines = body.splitlines()
        return "\n".join(line for line in lines if not (installed and INSTALLS.search(line)))
    if kind == "yaml":
        return f"cat > page-{n}.yaml <<'END'\n{body}END\nvisviva run page-{n}.yaml"
    if kind == "python":
        return f"cat >> page.py <<'END'\n{body}END"
    raise SystemExit(f"README.md has a block of {kind}, which nothing here runs")


def prepared(folder: Path) -> Path:
    """A copy of what the repository holds, and nothing that was built in it."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout
    for name in filter(None, listed.decode().split("\0")):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).exists():
            shutil.copy2(ROOT / name, target)
    return folder


def main() -> int:
    """Run the page; the exit code is that of the first command that fails."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--installed", action="store_true")
    installed = parser.parse_args().installed
    python = sys.executable if installed else ".venv/bin/python"
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = list(blocks(text))
    parts = [script(kind, body, n, installed) for n, (kind, body) in enumerate(found)]
    last = max(n for n, (kind, _) in enumerate(found) if kind == "python")
    parts[last] += '\n"$PYTHON" page.py'
    with tempfile.TemporaryDirectory() as folder:
        prepared(Path(folder))
        page = f"PYTHON={python}\n{HEADER}set -x\n" + "\n".join(parts)
        return subprocess.run(["bash", "-c", page, "bash", folder], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
