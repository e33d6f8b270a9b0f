"""Tests of what is in an FMU; a package, because of its helper `kite_on_rails`."""
