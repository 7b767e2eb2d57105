"""What exists in the world, and the types that cross from room to room."""

import os
import platform

# Each kernel of OpenBLAS rounds products in its own way, and takes effect when NumPy is imported.
# One kernel for every x86 processor with AVX2 makes state hashes independent of the environment.
if platform.machine().lower() in ("x86_64", "amd64"):
    os.environ["OPENBLAS_CORETYPE"] = "Haswell"
