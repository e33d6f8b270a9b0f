"""Tests of the four variants."""
