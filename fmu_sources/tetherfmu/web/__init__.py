"""The page for flights in the browser: one HTML, one script, one WebAssembly file with the kernels."""
