#!/usr/bin/python3
"""Writes the literal problems of the tiers `literature`, `nonsymmetric` and `friction-literature`: of textbooks, of
papers (friction_literals.py), and of Siconos' test data.

usage: literals.py LCPBENCH SICONOS SICONOS_2026 [-o FOLDER]

LCPBENCH is the command, SICONOS the unpacked source of Siconos 4.4.0 (`apt-get source siconos` of Debian 12),
SICONOS_2026 that of its repository at commit 6070f0f6, which has more problems in the plane. A file
problems/TIER.jsonl.gz of FOLDER (default: this one) is written for each tier; `lcpbench collection build` makes the
manifests from them. Needs python3-h5py for the files of FCLib.

Matrices go where they belong: to `literature` if `lcpbench certify` proves them symmetric positive semidefinite. Those
of contact problems that are symmetric to 1e-4 are made so, and the line says by how much; those that the rounding of
their numbers has made indefinite are left out. Of problems with friction `literature` has the rows of the normals, and
`friction-literature` all rows up to 10^4: as they are in the plane; in space, up to 120 rows, with a square in the place
of the disc that bounds friction.
"""

import argparse
import gzip
import json
import subprocess
from pathlib import Path

import friction_literals

SICONOS = "Siconos 4.4.0 (Debian 4.4.0+dfsg-2), numerics/src/"
CPS = "Cottle, Pang, Stone, The Linear Complementarity Problem, SIAM 2009, "
MURTY = "Murty, Linear Complementarity, Linear and Nonlinear Programming, 1988, "
MOST_ROWS_PROVED = 120  # that A is semidefinite, benchmarks/collection/references.h
SYMMETRIC = 1e-4
SICONOS_2026 = "Siconos, commit 6070f0f6, numerics/src/"
MOST_ROWS = 10_000  # with friction in the plane

# id, A, b, source
TEXTBOOKS = [
    ("murty-2-8", [[1, -1, -1, -1], [-1, 1, -1, -1], [1, 1, 2, 0], [1, 1, 0, 2]], [3, 5, -9, -5],
     MURTY + "example 2.8"),
    ("murty-2-9", [[-1, 0, -3], [1, -2, -5], [-2, -1, -2]], [-3, -2, -1],
     MURTY + "example 2.9: Lemke's method ends on a ray"),
    ("newton-min-cycle", [[1, 0, 2], [2, 1, 0], [0, 2, 1]], [-1, -1, -1],
     "Ben Gharbia, Gilbert, Math. Program. 134 (2012) 349-364: Newton's method on min(f, w) may cycle"),
]


def of_siconos(name):
    """Textbook examples that Siconos' files name."""
    return {
        "lcp_CPS_1": CPS + "remark 4.1.14", "lcp_CPS_2": CPS + "example 4.4.7", "lcp_CPS_3": CPS + "example 4.4.23",
        "lcp_CPS_5": CPS + "example 4.4.16", "lcp_exp_murty": MURTY + "chapter 6",
        "lcp_exp_murty2": MURTY + "chapter 6",
    }.get(name, "")


def dense(record):
    """A of a record of lcpbench, by rows."""
    matrix, n = record["A"], len(record["b"])
    if isinstance(matrix, dict):
        rows = [[0.0] * n for _ in range(n)]
        for i, j, value in zip(matrix["row"], matrix["col"], matrix["val"]):
            rows[i][j] += value
        return rows
    return matrix if isinstance(matrix[0], list) else [matrix[n * i:n * (i + 1)] for i in range(n)]


def rolling_friction(path):
    """The normal rows of contacts with rolling friction in Siconos' text format, which `lcpbench convert` refuses."""
    words = path.read_text(encoding="utf-8").split()
    dimension, contacts, storage = map(int, words[:3])
    if (dimension, storage) != (5, 0):
        raise ValueError(f"{path}: another layout")
    rows = dimension * contacts
    numbers = list(map(float, words[7:]))
    return {"n": contacts, "A": [numbers[rows * i:rows * (i + 1):dimension] for i in range(0, rows, dimension)],
            "b": numbers[rows * rows:rows * (rows + 1):dimension]}


def fclib_global(path):
    """J, 1/m and b of the normal rows of M v = H r + f, u = H^T v + w, without bodies that no contact touches."""
    import h5py  # pylint: disable=import-outside-toplevel

    with h5py.File(path) as file:
        problem = file["fclib_global"]
        dimension = int(problem["spacedim"][0])

        def triplets(name):
            matrix = problem[name]
            if matrix["nz"][0] != len(matrix["x"]):
                raise ValueError(f"{path}: {name} is not stored as triplets")
            rows, columns = int(matrix["m"][0]), int(matrix["n"][0])
            # Triplets of both orders are about; ranges tell.
            i, p = list(map(int, matrix["i"])), list(map(int, matrix["p"]))
            if max(i) >= rows or max(p) >= columns:
                i, p = p, i
            return list(zip(i, p, map(float, matrix["x"])))

        mass = triplets("M")
        if any(i != j for i, j, value in mass if value != 0):
            raise ValueError(f"{path}: M is not diagonal")
        inverse = {i: 1 / value for i, _, value in mass if value != 0}
        H = [(i, j // dimension, value) for i, j, value in triplets("H") if j % dimension == 0 and value != 0]
        width = 6 if dimension == 3 else 3
        blocks = sorted({i // width for i, _, _ in H})
        place = {block: k for k, block in enumerate(blocks)}
        f, w = list(map(float, problem["vectors/f"])), list(map(float, problem["vectors/w"]))
        rows = len(w) // dimension
        b = w[::dimension]
        for i, row, value in H:
            b[row] += value * inverse[i] * f[i]
        J = sorted((row, width * place[i // width] + i % width, value) for i, row, value in H)
        return {
            "J": {"shape": [rows, width * len(blocks)], "row": [e[0] for e in J], "col": [e[1] for e in J],
                  "val": [e[2] for e in J]},
            "invM": [inverse[width * block + k] for block in blocks for k in range(width)], "columns_per_body": width,
            "b": b}


class Writer:
    """Sorts problems into the two files; a content stands there once."""

    def __init__(self, lcpbench):
        self.lcpbench = lcpbench
        self.lines = {"literature": [], "nonsymmetric": [], "friction-literature": []}
        self.seen = set()

    def convert(self, path, *options, text=None):
        """The problem of a file, or of a record, as a record; none where the command refuses it."""
        run = subprocess.run([self.lcpbench, "convert", path, *options], input=text, text=True, check=False,
                             capture_output=True)
        return None if run.returncode else json.loads(run.stdout)

    def is_semidefinite(self, numbers):
        run = subprocess.run([self.lcpbench, "certify", "-"], input=json.dumps(numbers), text=True, check=False,
                             capture_output=True)
        return run.returncode == 0 and json.loads(run.stdout)["status"] in ("solved", "infeasible")

    def add(self, name, family, record, provenance, licence, base=None):
        numbers = {"A": dense(record), "b": record["b"]}
        if record.get("bilateral"):
            numbers["bilateral"] = record["bilateral"]
        psd = self.is_semidefinite(numbers)
        if family == "siconos-contacts" and not psd:
            return
        self.put("literature" if psd else "nonsymmetric", name, family, numbers, provenance, licence, base)

    def add_contacts(self, name, record, provenance, base=None):
        """The normal rows of contacts, as `convert --symmetrize` left them."""
        if record is None or not 1 < record["n"] <= MOST_ROWS_PROVED:
            return
        A = dense(record)
        if A != [list(column) for column in zip(*A)]:
            return
        if "symmetrized" in record:
            provenance += f"; A symmetrised, entries differed by {record['symmetrized']:.1e} of the diagonal"
        self.add(name, "siconos-contacts", record, provenance, "Apache-2.0", base)

    def add_friction(self, path, source):
        """All rows of contacts in the plane, or of few in space."""
        symmetrize = ("--symmetrize", str(SYMMETRIC))
        record, law = self.convert(path, *symmetrize), ""
        if record is None and path.stat().st_size < 1e6:
            record, law = self.convert(path, "--box-friction", *symmetrize), "-box"
        if record is None or "friction" not in record or record["n"] > (MOST_ROWS_PROVED if law else MOST_ROWS):
            return
        provenance = f"{source}FrictionContact/test/data/{path.name}"
        if law:
            provenance += "; a square in the place of the disc that bounds friction"
        if "A" in record:
            A = record["A"]
            entries = {(i, j): value for i, j, value in zip(A["row"], A["col"], A["val"])}
            if any(entries.get((j, i)) != value for (i, j), value in entries.items()):
                return
        if "symmetrized" in record:
            provenance += f"; A symmetrised, entries differed by {record['symmetrized']:.1e} of the diagonal"
        stem = path.name.removesuffix(".dat").removesuffix(".hdf5").lower().replace("_", "-")
        family = "siconos-contacts" + law
        base = next((f"siconos-{word}" for word in ("rover", "granularflowonwall") if word in stem), None)
        keys = ("A", "J", "invM", "columns_per_body", "b", "bilateral", "friction")
        self.put("friction-literature", f"siconos-{stem}-friction{law}", family,
                 {key: record[key] for key in keys if key in record}, provenance, "Apache-2.0", base)

    def put(self, tier, name, family, numbers, provenance, licence, base=None):
        content = json.dumps(numbers, sort_keys=True)
        if content in self.seen:
            return
        self.seen.add(content)
        record = {"id": name, "n": len(numbers["b"]), **numbers, "family": family, "provenance": provenance,
                  "licence": licence}
        if base:
            record["base"] = base
        self.lines[tier].append(json.dumps(record))

    def write(self, folder):
        for tier, lines in self.lines.items():
            text = "".join(line + "\n" for line in lines).encode()
            (folder / "problems" / f"{tier}.jsonl.gz").write_bytes(gzip.compress(text, 9, mtime=0))
            print(f"{tier}: {len(lines)} literal problems")


def add_siconos(writer, numerics):
    for path in sorted([*numerics.glob("LCP/test/data/*.dat"), *numerics.glob("MLCP/test/data/*.dat")]):
        record = writer.convert(path)
        if record is None or len(record["b"]) > MOST_ROWS_PROVED:
            continue
        place = path.relative_to(numerics)
        book = of_siconos(path.stem)
        writer.add("siconos-" + path.stem.lower().replace("_", "-"), "siconos-" + place.parts[0].lower(), record,
                   f"{SICONOS}{place}" + (f"; {book}" if book else ""), "Apache-2.0")
    contacts = numerics / "FrictionContact/test/data"
    symmetrize = ("--symmetrize", str(SYMMETRIC))
    for path in sorted(contacts.glob("*.dat")):
        try:
            record = writer.convert("-", *symmetrize, text=json.dumps(rolling_friction(path)))
        except ValueError:
            record = writer.convert(path, "--without-friction", *symmetrize)
        stem = path.name.removesuffix(".dat").removesuffix(".hdf5").lower().replace("_", "-")
        base = "siconos-rover" if stem.startswith("rover") else None
        writer.add_contacts("siconos-" + stem, record, f"{SICONOS}{path.relative_to(numerics)}, rows of the normals",
                            base)
    for path in sorted(contacts.glob("*.hdf5")):
        name = "fclib-" + path.stem.lower().replace("_", "-")
        source = f"{SICONOS}{path.relative_to(numerics)} (FCLib), rows of the normals"
        try:
            writer.put("literature", name, "fclib", fclib_global(path), source + "; inverse masses rounded",
                       "Apache-2.0")
        except KeyError:  # not a global problem
            writer.add_contacts(name, writer.convert(path, "--without-friction", *symmetrize), source)


def add_friction(writer, numerics, newer):
    for record in friction_literals.published():
        writer.lines["friction-literature"].append(json.dumps(record))
    folder = "FrictionContact/test/data"
    for path in sorted((numerics / folder).glob("*.dat")):
        writer.add_friction(path, SICONOS)
    for path in sorted((newer / folder).glob("*fc2d_granularflowonwall*.dat")):
        writer.add_friction(path, SICONOS_2026)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("lcpbench")
    parser.add_argument("siconos", type=Path)
    parser.add_argument("siconos_2026", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).resolve().parent)
    options = parser.parse_args()
    writer = Writer(options.lcpbench)
    for name, matrix, b, source in TEXTBOOKS:
        floats = [[float(value) for value in row] for row in matrix]
        writer.add(name, "textbooks", {"A": floats, "b": [float(value) for value in b]}, source, "CC0-1.0")
    add_siconos(writer, options.siconos / "numerics/src")
    add_friction(writer, options.siconos / "numerics/src", options.siconos_2026 / "numerics/src")
    writer.write(options.output)


if __name__ == "__main__":
    main()
