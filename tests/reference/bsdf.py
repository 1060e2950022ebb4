# tests/reference/bsdf.py -- Fresnel curves, microfacets and BSDFs of Mitsuba 3, with their derivatives
# SPDX-License-Identifier: Apache-2.0
import numpy as np

from inputs import between


def arrays():
    out = {}
    out["inputs"] = (np.stack([between(1, 250, j, -3, 0.7) for j in range(4)], 1), 0)
    return out
