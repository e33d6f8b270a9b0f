"""Tests of what an FMU does in a host; a package, because other tests use its hosts (`host`, `clients`)."""
