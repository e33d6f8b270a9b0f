"""The four tethers: for each one its first state, one communication step, its outputs. Imports all packages of `kernels`."""
