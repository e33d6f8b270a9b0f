"""Tests of native FMUs; a package, because benchmarks use what compiles its programs (`programs`)."""
