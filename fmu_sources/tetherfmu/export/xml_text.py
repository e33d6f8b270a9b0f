"""Text of XML files, written in one way."""

from xml.etree.ElementTree import indent, tostring

DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'


def xml_text(root):
    """Text of the file with this Element as its root, which is indented (modified)."""
    indent(root)
    return DECLARATION + tostring(root, encoding="unicode") + "\n"
