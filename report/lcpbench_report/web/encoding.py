"""Numbers over many decades in two bytes each: times and residuals need 0.07 %, not sixteen digits.

A value x > 0 is stored as round(1600 log10 x), which reaches from 1e-20 to 1e20; what is smaller or larger is moved to
the nearest of these. data.js reads it.
"""

import base64

import numpy as np

STEPS_PER_DECADE = 1600
LARGEST = 32000
ZERO, INFINITE, UNKNOWN = -32767, 32767, -32768
NO_SPREAD = 255


def pack(values) -> str:
    """Base64 of little-endian 16-bit integers. NaN is unknown; negative values are not expected."""
    given = np.asarray(values, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.rint(np.log10(given) * STEPS_PER_DECADE)
    codes = np.clip(np.nan_to_num(logs, nan=0, posinf=LARGEST, neginf=-LARGEST), -LARGEST, LARGEST)
    codes = np.where(np.isnan(given), UNKNOWN, np.where(given == 0, ZERO, np.where(np.isinf(given), INFINITE, codes)))
    return base64.b64encode(codes.astype("<i2").tobytes()).decode("ascii")


def pack_shares(values) -> str:
    """Base64 of bytes: whole per cents from 0 to 254, 255 for what is not known. What is larger is shown as 254."""
    given = np.asarray(values, dtype=float)
    codes = np.where(np.isnan(given), NO_SPREAD, np.clip(np.rint(np.nan_to_num(given) * 100), 0, 254))
    return base64.b64encode(codes.astype("u1").tobytes()).decode("ascii")
