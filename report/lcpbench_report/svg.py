"""Makes an SVG document safe to stand inside an HTML page among others.

Ids get a prefix, style sheets are confined to their own picture, scripts, event handlers and links to anything outside
the document are dropped, and the size becomes a viewBox so that the page decides how wide it is.
"""

import re
import xml.etree.ElementTree as ET

from .errors import ReportError

_SVG = "{http://www.w3.org/2000/svg}"
_XLINK_HREF = "{http://www.w3.org/1999/xlink}href"
_DROPPED = {"script", "foreignObject", "metadata", "iframe"}
_URL = re.compile(r"url\(\s*['\"]?#([^)'\"]+)['\"]?\s*\)")


def embed(text: str, prefix: str, label: str, file: str = "figure") -> str:
    """The <svg> element of `text` as markup for an HTML page.

    @param prefix  unique within the page, [a-z0-9-]+; becomes the id of the root
    @param label   what the picture shows, for screen readers
    @throws ReportError naming `file` when the text is not SVG
    """
    try:
        root = ET.fromstring(text)
    except ET.ParseError as error:
        raise ReportError(file, f"not well-formed XML ({error})", "an SVG document") from error
    if root.tag not in (_SVG + "svg", "svg"):
        raise ReportError(file, f"the root element is <{_local(root.tag)}>", "<svg>")
    _drop(root)
    for element in root.iter():
        element.tag = _local(element.tag)
        _rewrite_attributes(element, prefix)
        if element.tag == "style":
            element.text = _confine(element.text or "", prefix)
    _fit(root)
    root.set("id", prefix)
    root.set("role", "img")
    root.set("aria-label", label)
    return ET.tostring(root, encoding="unicode")


def _local(tag: object) -> str:
    return tag.rsplit("}", 1)[-1] if isinstance(tag, str) else ""


def _drop(parent: ET.Element) -> None:
    for child in list(parent):
        if _local(child.tag) in _DROPPED:
            parent.remove(child)
        else:
            _drop(child)


def _rewrite_attributes(element: ET.Element, prefix: str) -> None:
    for name, value in list(element.attrib.items()):
        local = _local(name)
        del element.attrib[name]
        if local.startswith("on"):
            continue
        if local == "id":
            value = f"{prefix}-{value}"
        elif local == "href":
            if value.startswith("#"):
                value = f"#{prefix}-{value[1:]}"
            elif not value.startswith("data:image/"):
                continue
        elif local in ("aria-labelledby", "aria-describedby"):
            value = " ".join(f"{prefix}-{part}" for part in value.split())
        elif local.startswith("xmlns"):
            continue
        element.set(local, _prefix_urls(value, prefix))


def _prefix_urls(value: str, prefix: str) -> str:
    return _URL.sub(lambda match: f"url(#{prefix}-{match.group(1)})", value)


def _confine(css: str, prefix: str) -> str:
    """Puts '#prefix ' before every selector, so that the rules of one picture do not reach the rest of the page."""
    css = re.sub(r"/\*.*?\*/", "", css, flags=re.DOTALL)
    css = re.sub(r"@(import|charset|namespace)[^;]*;", "", css)
    rules = []
    for selectors, body in re.findall(r"([^{}@]+)\{([^{}]*)\}", css):
        confined = []
        for selector in selectors.split(","):
            selector = re.sub(r"#([A-Za-z_][\w-]*)", rf"#{prefix}-\1", selector.strip())
            confined.append(f"#{prefix}" + ("" if selector in ("svg", ":root") else f" {selector}"))
        rules.append(f"{','.join(confined)}{{{_prefix_urls(body.strip(), prefix)}}}")
    return "\n".join(rules)


def _fit(root: ET.Element) -> None:
    """width and height become a viewBox."""
    size = [re.match(r"[\d.]+", root.get(key, "")) for key in ("width", "height")]
    if "viewBox" not in root.attrib and all(size):
        root.set("viewBox", f"0 0 {size[0].group()} {size[1].group()}")
    if "viewBox" in root.attrib:
        for key in ("width", "height"):
            root.attrib.pop(key, None)
