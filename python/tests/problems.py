"""Random problems for the tests, as arguments of lcpbench.solve and as JSON lines of the command."""

import json

import numpy as np
from scipy import sparse

FORMS = ("dense", "sparse", "factors")
LAWS = ("plain", "bilateral", "friction", "bounded")


def random_problem(seed, rows, form, laws, bodies=None):
    """The arguments of a problem of rigid bodies: `rows` rows of J with six entries on two bodies each.

    laws "friction": every other row is the tangent of the contact before it; "bounded": a third of the rows.
    """
    random = np.random.default_rng(seed)
    bodies = bodies or 2 + rows // 2
    first = random.integers(0, bodies, rows)
    second = (first + random.integers(1, bodies, rows)) % bodies
    column = 3 * np.stack([first, second], 1).repeat(3, 1) + np.tile(np.arange(3), 2)
    value = random.normal(size=(rows, 6))
    J = sparse.csr_matrix((value.ravel(), (np.arange(rows).repeat(6), column.ravel())), shape=(rows, 3 * bodies))
    inverse_mass = random.uniform(0.1, 3, 3 * bodies)
    arguments = {"b": random.normal(size=rows)}
    if form == "factors":
        arguments |= {"J": J, "inverse_mass": inverse_mass}
    else:
        A = (J @ sparse.diags(inverse_mass) @ J.T).tocsr()
        A = (A + A.T) / 2 + 0.1 * sparse.eye(rows)
        A.sort_indices()
        arguments["A"] = A if form == "sparse" else A.toarray()
    if laws == "bilateral":
        arguments["bilateral"] = random.random(rows) < 0.2
    elif laws == "friction":
        tangent = np.arange(1, rows, 2)
        arguments["friction"] = {"row": tangent, "normal": tangent - 1, "mu": random.uniform(0, 1, len(tangent))}
    elif laws == "bounded":
        row = np.arange(0, rows, 3)
        arguments["bounded"] = {"row": row, "lower": -random.uniform(0, 1, len(row)),
                                "upper": random.uniform(0, 1, len(row))}
    return arguments


def json_line(arguments):
    """The same problem for the command."""
    def matrix(given):
        if not sparse.issparse(given):
            return given.tolist()
        triplets = given.tocoo()
        return {"shape": list(given.shape), "row": triplets.row.tolist(), "col": triplets.col.tolist(),
                "val": triplets.data.tolist()}

    record = {"b": arguments["b"].tolist()}
    if "J" in arguments:
        record |= {"J": matrix(arguments["J"]), "invM": arguments["inverse_mass"].tolist()}
    else:
        record["A"] = matrix(arguments["A"])
    if "bilateral" in arguments:
        record["bilateral"] = np.flatnonzero(arguments["bilateral"]).tolist()
    for law in ("friction", "bounded"):
        if law in arguments:
            record[law] = {name: values.tolist() for name, values in arguments[law].items()}
    return json.dumps(record)
