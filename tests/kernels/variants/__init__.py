"""Tests of the four variants; a package, because they share `balance`."""
