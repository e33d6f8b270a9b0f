"""The four tethers: initial state, communication step and outputs of each. Imports all packages of `kernels`."""
