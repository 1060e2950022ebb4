#!/usr/bin/env python3
# tests/reference/generate.py -- makes the numbers in data/ with Mitsuba 3 and PyTorch, or says that they have changed
# SPDX-License-Identifier: Apache-2.0
"""Makes the reference numbers of tests/reference/data with Mitsuba 3.9.1 and Dr.Jit 1.5.0, those of networks with
PyTorch 1.13, and compares them with the files there. Exits with 1 and names array, worst difference and tolerance where
they differ, with 2 where it cannot work.

to set up (Debian 12; only vgg wants torch, and nothing else):
  apt-get install libllvm19 python3-torch
  python3 -m venv --system-site-packages mitsuba && mitsuba/bin/pip install mitsuba==3.9.1 drjit==1.5.0 numpy
examples:
  mitsuba/bin/python tests/reference/generate.py                makes all, compares with the committed files
  mitsuba/bin/python tests/reference/generate.py --only bsdf    one module, here bsdf.py
  mitsuba/bin/python tests/reference/generate.py --write        writes the files anew
"""
import argparse
import glob
import importlib
import os
import pathlib
import re
import sys
import time

VERSIONS = {"mitsuba": "3.9.1", "drjit": "1.5.0"}
# Each module has arrays(): a dict {name: (array, tolerance)} whose arrays become data/<name>.npy. See README.md.
MODULES = ["bsdf", "emitter_texture", "images", "insertion", "vgg"]
WITHOUT_MITSUBA = ["vgg"]
HERE = pathlib.Path(__file__).resolve().parent


def give_up(text):
    print(f"generate.py: {text}", file=sys.stderr)
    sys.exit(2)


def load_mitsuba():
    """Checks versions, finds LLVM, sets the variant. Modules that are imported after it say `import mitsuba as mi`."""
    from importlib import metadata
    for package, version in VERSIONS.items():
        try:
            found = metadata.version(package)
        except metadata.PackageNotFoundError:
            found = "none"
        if found != version:
            give_up(f"found {package} {found}, expected {version}; pip install {package}=={version}")
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        found = [glob.glob(f"/usr/lib/*/libLLVM*.so.{v}*") for v in (19, 18, 17, 20, 21)]  # 19 made the committed files
        found = [path for paths in found for path in paths]
        if not found:
            give_up("found no libLLVM 17 to 21; apt-get install libllvm19, or set DRJIT_LIBLLVM_PATH")
        os.environ["DRJIT_LIBLLVM_PATH"] = found[0]
    path = os.environ["DRJIT_LIBLLVM_PATH"]
    if re.search(r"libLLVM-1[4-6]", os.path.realpath(path)):
        give_up(f"found {path}, expected LLVM 17 or later; on 15 and 16 every maximum aborts: Cannot select: fmaximum")
    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)


def difference(new, old):
    """The worst |new - old| / max(|old|, mean |old|); numbers that are finite in one only differ by infinity."""
    import numpy as np
    a, b = np.asarray(new, np.float64), np.asarray(old, np.float64)
    if a.size == 0:
        return 0.0
    ok = np.isfinite(a) & np.isfinite(b)
    if not np.array_equal(np.isfinite(a), np.isfinite(b)) or not np.array_equal(a[~ok], b[~ok], equal_nan=True):
        return np.inf
    size = np.maximum(np.abs(b), np.mean(np.abs(b[ok])) if ok.any() else 1)
    return float(np.max(np.abs(a - b)[ok] / np.maximum(size[ok], 1e-30), initial=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the files instead of comparing with them")
    parser.add_argument("--only", choices=MODULES, help="make the arrays of one module")
    args = parser.parse_args()
    if args.only not in WITHOUT_MITSUBA:
        load_mitsuba()
    import numpy as np
    sys.path.insert(0, str(HERE))
    data = HERE / "data"
    data.mkdir(exist_ok=True)

    made, bad, size = set(), 0, 0
    for module in [args.only] if args.only else MODULES:
        if not (HERE / f"{module}.py").exists():
            print(f"{module}: there is no {module}.py")
            continue
        start = time.time()
        print(f"{module}: making", flush=True)
        arrays = importlib.import_module(module).arrays()
        print(f"{module}: {len(arrays)} arrays in {time.time() - start:.0f} s", flush=True)
        for name, (array, tolerance) in arrays.items():
            path, array = data / f"{name}.npy", np.ascontiguousarray(array)
            if name in made:
                give_up(f"two arrays are called {name}")
            made.add(name)
            size += array.nbytes
            if array.dtype.str not in ("<f4", "<f2", "<i4", "|u1"):
                give_up(f"{name}: found type {array.dtype}, expected float32, float16, int32 or uint8")
            if args.write:
                beside = path.with_suffix(".npy.new")
                with open(beside, "wb") as file:
                    np.save(file, array)
                beside.rename(path)
                continue
            if not path.exists():
                text = "no such file is committed"
            else:
                old = np.load(path)
                if old.shape != array.shape or old.dtype != array.dtype:
                    text = f"made {array.dtype}{array.shape}, committed {old.dtype}{old.shape}"
                else:
                    worst = difference(array, old)
                    text = "" if worst <= tolerance else f"worst difference {worst:.3g}, tolerance {tolerance:.3g}"
            if text:
                bad += 1
                print(f"{name}: DIFFERS: {text}", flush=True)
    if not args.only:
        for path in sorted(data.glob("*.npy")):
            if path.stem not in made:
                bad += 1
                print(f"{path.name}: DIFFERS: no module makes it")
    print(f"{len(made)} arrays, {size / 1e6:.2f} MB: " +
          ("written" if args.write else f"{bad} differ" if bad else "all as committed"))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
