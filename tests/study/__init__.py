"""Tests of the studies, in the rooms of the package; a package, because they share `scenes_of_tests`."""
