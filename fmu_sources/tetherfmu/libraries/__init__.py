"""From kernels to shared libraries, one per variant and platform, for the Python API, the studies and the FMUs.

`ready` finds them, and has missing ones compiled: once for each content of the sources.
"""
