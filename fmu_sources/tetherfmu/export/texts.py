"""Texts of XML files, and of filled-in asset templates."""

from pathlib import Path
from string import Template
from xml.etree.ElementTree import indent, tostring

ASSETS = Path(__file__).with_name("assets")
DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'


def xml_text(root):
    """Text of the file with this Element as its root, which is indented (modified)."""
    indent(root)
    return DECLARATION + tostring(root, encoding="unicode") + "\n"


def asset(file):
    """Text of an asset."""
    return (ASSETS / file).read_text(encoding="utf-8")


def filled(file, /, **values):
    """Text of an asset with its $names replaced."""
    return Template(asset(file)).substitute(values)
