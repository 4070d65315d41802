"""What the report knows of solvers: words for what campaign.json says of them, and what it does not say."""

# Own solvers, whether a campaign has them or not, so that colours are the same in all. The first six have a colour
# each: what a motion is solved with, and the classics it is compared with. Others come behind.
KNOWN = ("auto", "dantzig", "bpp", "ipm", "pgs", "lemke", "semismooth-newton", "active-set", "psor", "nncg", "apgd",
         "ipopt-qp", "ipopt-ncp", "hybrid")
LIBRARIES = ("bullet", "ode", "dart", "siconos", "petsc", "tao", "cgal", "clp")
# Markers of peers' methods, one meaning as far as they go; other methods have the library's first free one.
MARKERS = {"dantzig": "o", "lemke": "s", "lexicolemke": "s", "pgs": "^", "newton-fb": "D", "nsgs-sbm": "v", "avi": "P",
           "rsls": "o", "ssls": "D", "bntr": "o", "tron": "s", "qp": "o", "clp": "o"}
VARIANTS = ("default", "cfm", "tuned")  # endings of a peer's keys that are other settings of the same method
ORIGINS = {"own": "ours", "peer": "another project's", "external": "named by the user"}
TOLERANCES = {"direct": "none (direct)", "follows": "the tier", "default": "its library's own"}


def library(entry: dict) -> str:
    """What a solver belongs to: a peer's library is its key up to the first '-'; an external solver is its own."""
    return entry["key"].split("-")[0] if entry["origin"] == "peer" else entry["key"]


def method(entry: dict) -> str:
    """The key of the solver of which this one is another setting, or its own."""
    if entry.get("base"):
        return entry["base"]
    base, _, variant = entry["key"].rpartition("-")
    return base if entry["origin"] == "peer" and base and variant in VARIANTS else entry["key"]


def setting(entry: dict) -> str:
    """How it was set, in words; of a variant its settings follow."""
    if entry["setting"] == "variant":
        return f"{entry.get('base', '')} with"
    if entry["setting"] == "tuned" and entry["origin"] == "peer":
        return "stopping options chosen per tier by one rule"
    return "as committed" if entry["origin"] == "own" else "the library's own defaults"
