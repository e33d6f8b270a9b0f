"""The FMUs of the examples, for the examples that fly them."""

from example_fmus.conftest import example_folder

__all__ = ["example_folder"]
