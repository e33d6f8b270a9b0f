"""Files of other programs as scenes and systems: settings of KiteUtils.jl, line files of MoorDyn."""
