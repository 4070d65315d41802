"""Plotly's script, minified, from Debian's python3-plotly: the page must open from disk, without a network."""

import re
import shutil
import subprocess
from pathlib import Path

from .errors import ReportError

BUNDLE = Path("/usr/share/python3-plotly/plotly.js")


def minified(bundle: Path = BUNDLE) -> str:
    """With the licence's notice at its beginning, and safe inside a <script>.

    @throws ReportError where the bundle or esbuild is missing
    """
    if not bundle.is_file():
        raise ReportError(str(bundle), "missing", "Debian's package python3-plotly (cmake/packages/packages.txt)")
    if shutil.which("esbuild") is None:
        raise ReportError("esbuild", "not found", "Debian's package esbuild (cmake/packages/packages.txt)")
    source = bundle.read_text(encoding="utf-8")
    notice = re.match(r"/\*.*?\*/", source, re.DOTALL)
    made = subprocess.run(["esbuild", "--minify", "--log-level=error"], input=source, capture_output=True, text=True,
                          check=False)
    if made.returncode:
        raise ReportError(str(bundle), f"esbuild says {made.stderr.strip()[:200]!r}", "a script that it can minify")
    text = made.stdout.replace("</script", r"<\/script").replace("<!--", r"<\!--")
    return (notice.group(0) + "\n" if notice else "") + text
