"""The page in which one flies a tether in the browser: one HTML, one script, one WebAssembly file with the kernels."""
