"""Materials, paths, arguments of Python classes, and whether a system fits together."""
