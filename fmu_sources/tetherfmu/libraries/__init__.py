"""From kernels to shared libraries, one per variant and platform: what the Python API, the studies and the FMUs all call.

`ready` finds them, and has them compiled where they are missing: once for each content of the sources.
"""
