"""Systems of tethers: lines between driven and free points, moved in one step.

Records with their checks, the flat arrays of a system, the start of its free points, and the class that users see. It needs
the single tethers of `runtime.instance` and the compiled libraries; nothing imports it but users.
"""
