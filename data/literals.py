#!/usr/bin/python3
"""Writes the literal problems of the tiers `literature` and `nonsymmetric`: of textbooks, and of Siconos' test data.

usage: literals.py LCPBENCH SICONOS [-o FOLDER]

LCPBENCH is the command, SICONOS the unpacked source of Siconos 4.4.0 (`apt-get source siconos` of Debian 12). Files
problems/literature.jsonl.gz and problems/nonsymmetric.jsonl.gz of FOLDER (default: this one) are written;
`lcpbench collection build` makes the manifests from them. Needs python3-h5py for the files of FCLib.

Matrices go where they belong: to `literature` if `lcpbench certify` proves them symmetric positive semidefinite. Those
of contact problems that are symmetric to 1e-4 are made so, and the line says by how much; those that the rounding of
their numbers has made indefinite are left out. Of problems with friction the rows of the normals are taken.
"""

import argparse
import gzip
import json
import math
import subprocess
import tempfile
from pathlib import Path

SICONOS = "Siconos 4.4.0 (Debian 4.4.0+dfsg-2), numerics/src/"
CPS = "Cottle, Pang, Stone, The Linear Complementarity Problem, SIAM 2009, "
MURTY = "Murty, Linear Complementarity, Linear and Nonlinear Programming, 1988, "
MOST_ROWS_PROVED = 120  # that A is semidefinite, benchmarks/collection/references.h
SYMMETRIC = 1e-4

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


def asymmetry(matrix):
    """max |A_ij - A_ji| / sqrt(|A_ii A_jj|)."""
    n = range(len(matrix))
    return max((abs(matrix[i][j] - matrix[j][i]) / (math.sqrt(abs(matrix[i][i] * matrix[j][j])) or 1)
                for i in n for j in range(i)), default=0)


def symmetrised(matrix):
    n = range(len(matrix))
    return [[(matrix[i][j] + matrix[j][i]) / 2 for j in n] for i in n]


def dense(record):
    """A of a record of lcpbench, by rows."""
    matrix, n = record["A"], len(record["b"])
    if isinstance(matrix, dict):
        rows = [[0.0] * n for _ in range(n)]
        for i, j, value in zip(matrix["row"], matrix["col"], matrix["val"]):
            rows[i][j] += value
        return rows
    return matrix if isinstance(matrix[0], list) else [matrix[n * i:n * (i + 1)] for i in range(n)]


class FrictionText:
    """The normal rows of a contact problem in Siconos' text format: dense W, or W in sparse blocks."""

    def __init__(self, path):
        words = iter(path.read_text(encoding="utf-8").split())
        integer, number = (lambda: int(next(words))), (lambda: float(next(words)))
        dimension, contacts, storage, rows, columns = (integer() for _ in range(5))
        if rows != dimension * contacts or columns != rows or storage not in (0, 1):
            raise ValueError(f"{path}: another layout")
        self.W = [[0.0] * contacts for _ in range(contacts)]
        if storage == 0:
            integer(), integer()
            for i in range(rows):
                for j in range(rows):
                    value = number()
                    if i % dimension == 0 and j % dimension == 0:
                        self.W[i // dimension][j // dimension] = value
        else:
            blocks, block_rows, block_columns = (integer() for _ in range(3))
            ends = [integer() for _ in range(block_rows)]
            if block_columns != block_rows or ends != [dimension * (k + 1) for k in range(contacts)]:
                raise ValueError(f"{path}: blocks of another size")
            for _ in range(block_columns):
                integer()
            filled = integer(), integer()
            starts = [integer() for _ in range(filled[0])]
            places = [integer() for _ in range(filled[1])]
            for k in range(blocks):
                integer()
                values = [number() for _ in range(dimension * dimension)]
                row = next(i for i in range(contacts) if starts[i] <= k < starts[i + 1])
                self.W[row][places[k]] = values[0]
        self.b = [number() for _ in range(rows)][::dimension]


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


def fclib_local(path):
    """W, by rows, and b of the normal rows of u = W r + q; W is stored by compressed rows."""
    import h5py  # pylint: disable=import-outside-toplevel

    with h5py.File(path) as file:
        problem = file["fclib_local"]
        dimension, matrix = int(problem["spacedim"][0]), problem["W"]
        if matrix["nz"][0] != -2:
            raise ValueError(f"{path}: W is not stored by rows")
        start, column, value = (list(matrix[key]) for key in ("p", "i", "x"))
        contacts = (len(start) - 1) // dimension
        W = [[0.0] * contacts for _ in range(contacts)]
        for i in range(contacts):
            for k in range(start[dimension * i], start[dimension * i + 1]):
                if column[k] % dimension == 0:
                    W[i][column[k] // dimension] = float(value[k])
        return W, list(map(float, problem["vectors/q"]))[::dimension]


class Writer:
    """Sorts problems into the two files; a content stands there once."""

    def __init__(self, lcpbench):
        self.lcpbench = lcpbench
        self.lines = {"literature": [], "nonsymmetric": []}
        self.seen = set()

    def is_semidefinite(self, numbers):
        run = subprocess.run([self.lcpbench, "certify", "-"], input=json.dumps(numbers), text=True, check=False,
                             capture_output=True)
        return run.returncode == 0 and json.loads(run.stdout)["status"] in ("solved", "infeasible")

    def add(self, name, family, matrix, rest, provenance, licence, base=None):
        matrix = [[float(value) for value in row] for row in matrix]
        off = asymmetry(matrix)
        if family == "siconos-contacts":
            if not 1 < len(matrix) <= MOST_ROWS_PROVED or off > SYMMETRIC:
                return
            if off > 0:
                matrix = symmetrised(matrix)
                provenance += f"; A symmetrised, entries differed by {off:.1e} of the diagonal"
        psd = self.is_semidefinite({"A": matrix, **rest})
        if family == "siconos-contacts" and not psd:
            return
        tier = "literature" if psd else "nonsymmetric"
        self.put(tier, name, family, {"A": matrix, **rest}, provenance, licence, base)

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
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "problem.jsonl"
            convert = subprocess.run([writer.lcpbench, "convert", path, "-o", out], check=False, capture_output=True)
            if convert.returncode:
                continue  # a storage or a shape that it does not have
            record = json.loads(out.read_text(encoding="utf-8"))
        if len(record["b"]) > MOST_ROWS_PROVED:
            continue
        rest = {"b": record["b"]} | ({"bilateral": record["bilateral"]} if record.get("bilateral") else {})
        place = path.relative_to(numerics)
        book = of_siconos(path.stem)
        writer.add("siconos-" + path.stem.lower().replace("_", "-"), "siconos-" + place.parts[0].lower(),
                   dense(record), rest, f"{SICONOS}{place}" + (f"; {book}" if book else ""), "Apache-2.0")
    contacts = numerics / "FrictionContact/test/data"
    for path in sorted(contacts.glob("*.dat")):
        try:
            problem = FrictionText(path)
        except (ValueError, StopIteration, RuntimeError):  # another layout
            continue
        stem = path.name.removesuffix(".dat").removesuffix(".hdf5").lower().replace("_", "-")
        base = "siconos-rover" if stem.startswith("rover") else None
        writer.add("siconos-" + stem, "siconos-contacts", problem.W, {"b": problem.b},
                   f"{SICONOS}{path.relative_to(numerics)}, rows of the normals", "Apache-2.0", base)
    for path in sorted(contacts.glob("*.hdf5")):
        name = "fclib-" + path.stem.lower().replace("_", "-")
        source = f"{SICONOS}{path.relative_to(numerics)} (FCLib), rows of the normals"
        try:
            writer.put("literature", name, "fclib", fclib_global(path), source + "; inverse masses rounded",
                       "Apache-2.0")
        except KeyError:  # not a global problem
            W, b = fclib_local(path)
            writer.add(name, "siconos-contacts", W, {"b": b}, source, "Apache-2.0")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("lcpbench")
    parser.add_argument("siconos", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).resolve().parent)
    options = parser.parse_args()
    writer = Writer(options.lcpbench)
    for name, matrix, b, source in TEXTBOOKS:
        writer.add(name, "textbooks", matrix, {"b": [float(value) for value in b]}, source, "CC0-1.0")
    add_siconos(writer, options.siconos / "numerics/src")
    writer.write(options.output)


if __name__ == "__main__":
    main()
