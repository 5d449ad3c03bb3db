"""XML from anyone: small, flat, without entities; and checked access to its elements and attributes.

Every refusal names the element and its line.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from xml.parsers import expat

from ..errors import LayersError

MAX_BYTES = 16 * 2**20
MAX_DEPTH = 8
MAX_ELEMENTS = 100_000
_NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
_WHOLE = re.compile(r"[0-9]{1,9}")


class Node:
    """One element. Attributes and children are asked for once; `finish` refuses what nobody asked for."""

    def __init__(self, tag, path, line, attributes):
        self.tag, self.path, self.line = tag, path, line
        self._attributes, self._children, self._asked = attributes, [], set()

    @property
    def where(self) -> str:
        """Its path and line, as messages begin."""
        return f"{self.path}, line {self.line}"

    def fail(self, message):
        """Raise LayersError for this element."""
        raise LayersError(f"{self.where}: {message}")

    def finish(self):
        """Refuse attributes and elements that were not asked for."""
        for name in self._attributes:
            if name not in self._asked:
                self.fail(f"unknown attribute {_shown(name)}")
        for child in self._children:
            if child.tag not in self._asked:
                child.fail("unknown element")

    def text(self, name, default=None):
        """The attribute's text without blanks around it; refused as missing if there is no default."""
        self._asked.add(name)
        value = self._attributes.get(name, default)
        if value is None:
            self.fail(f"attribute {name} is missing")
        return value.strip()

    def numbers(self, name, count, default=None):
        """`count` finite numbers, a list of float."""
        text = self.text(name, default)
        words = text.split()
        if len(words) != count or not all(_NUMBER.fullmatch(word) for word in words):
            self._refuse(name, text, "a number" if count == 1 else f"{count} numbers")
        values = [float(word) for word in words]
        if not all(math.isfinite(value) for value in values):
            self._refuse(name, text, "finite")
        return values

    def number(self, name, *, least=None, above=None, default=None):
        """One finite number within a bound."""
        value = self.numbers(name, 1, default)[0]
        if (least is not None and value < least) or (above is not None and value <= above):
            self._refuse(
                name,
                self.text(name, default),
                f"{'above' if least is None else 'at least'} {above if least is None else least}",
            )
        return value

    def whole_numbers(self, name, count, default=None):
        """`count` whole numbers from 0 to 999999999, a list of int."""
        text = self.text(name, default)
        words = text.split()
        if len(words) != count or not all(_WHOLE.fullmatch(word) for word in words):
            right = "a whole number" if count == 1 else f"{count} whole numbers"
            self._refuse(name, text, f"{right} of at most 9 digits")
        return [int(word) for word in words]

    def choice(self, name, choices, default=None):
        """One of some texts."""
        value = self.text(name, default)
        if value not in choices:
            self._refuse(name, value, "one of " + ", ".join(choices))
        return value

    def has(self, name):
        """Whether the attribute is there."""
        return name in self._attributes

    def children(self, *tags):
        """The elements of these names, in the order of the file."""
        self._asked.update(tags)
        return [child for child in self._children if child.tag in tags]

    def child(self, tag):
        """The one element of this name; refused if there is none or another."""
        found = self.children(tag)
        if not found:
            self.fail(f"element {tag} is missing")
        if len(found) > 1:
            found[1].fail("a second one; there must be one")
        return found[0]

    def _refuse(self, name, value, right):
        self.fail(f"{name} is {_shown(value)}, must be {right}")


def read_nodes(path) -> Node:
    """The root element of the XML file at `path`, with all that it holds.

    No DOCTYPE, and with it no entity, is let in; neither is a file larger than MAX_BYTES, of more than
    MAX_ELEMENTS elements, deeper than MAX_DEPTH, or with text between the elements.

    Raises: LayersError naming the line; OSError when the file cannot be opened.
    """
    with open(Path(path), "rb") as file:
        text = file.read(MAX_BYTES + 1)
    if len(text) > MAX_BYTES:
        raise LayersError(f"larger than {MAX_BYTES >> 20} MiB, the limit")
    parser = expat.ParserCreate()
    builder = _Builder(parser)
    try:
        parser.Parse(text, True)
    except LayersError:
        raise
    except (expat.ExpatError, LookupError, ValueError) as error:  # the latter two: encodings it lacks
        raise LayersError(f"no XML that can be read: {error}") from error
    return builder.root


class _Builder:
    """The parser's handlers; keeps the open elements."""

    def __init__(self, parser):
        self._parser, self._open, self._count, self._counts = parser, [], 0, [{}]
        self.root = None
        parser.StartDoctypeDeclHandler = self._doctype
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._text

    def _doctype(self, name, *_):
        raise LayersError(f"line {self._parser.CurrentLineNumber}: a DOCTYPE, which could define entities")

    def _start(self, tag, attributes):
        self._count += 1
        line = self._parser.CurrentLineNumber
        if len(self._open) >= MAX_DEPTH:
            raise LayersError(f"line {line}: elements more than {MAX_DEPTH} deep")
        if self._count > MAX_ELEMENTS:
            raise LayersError(f"line {line}: more than {MAX_ELEMENTS} elements")
        number = self._counts[-1][tag] = self._counts[-1].get(tag, 0) + 1
        name = _shown(tag).strip("'") + (f"[{number}]" if number > 1 else "")
        node = Node(tag, f"{self._open[-1].path}/{name}" if self._open else name, line, attributes)
        if self._open:
            self._open[-1]._children.append(node)
        else:
            self.root = node
        self._open.append(node)
        self._counts.append({})

    def _end(self, _):
        self._open.pop()
        self._counts.pop()

    def _text(self, text):
        if text.strip():
            line = self._parser.CurrentLineNumber
            raise LayersError(f"{self._open[-1].path}, line {line}: text {_shown(text.strip())}")


def _shown(value):
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "…'"
