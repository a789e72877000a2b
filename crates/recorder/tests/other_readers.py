"""Reads CSV files with other programs, and compares every cell with what the file has to say.

Run by `cargo xtask test --only csv-readers`:
other_readers.py csv FILE EXPECTED      by Python's csv module
other_readers.py pandas FILE EXPECTED   by pandas
other_readers.py fods FILE EXPECTED     FILE is the spreadsheet that LibreOffice made of the CSV file

EXPECTED has a row in each line, as JSON: the names of the columns, then numbers, texts and null.
"""

import csv
import json
import sys
from xml.etree import ElementTree

import pandas

TABLE = "{urn:oasis:names:tc:opendocument:xmlns:table:1.0}"
OFFICE = "{urn:oasis:names:tc:opendocument:xmlns:office:1.0}"
TEXT = "{urn:oasis:names:tc:opendocument:xmlns:text:1.0}"

# Empty cells up to the right edge of the sheet are one element.
COLUMNS_MAX = 100


def by_csv(path, expected):
    """Every cell is a text here: it becomes a number where one is expected."""
    # Of a file without a byte order mark, this encoding is UTF-8.
    with open(path, encoding="utf-8-sig", newline="") as file:
        rows = list(csv.reader(file))
    for row, wanted in zip(rows, expected):
        numbers = [isinstance(cell, (int, float)) for cell in wanted]
        yield [float(cell) if number else cell or None for cell, number in zip(row, numbers)]
    assert len(rows) == len(expected)


def by_pandas(path, _):
    frame = pandas.read_csv(path)
    yield list(frame.columns)
    yield from frame.astype(object).where(frame.notna(), None).values.tolist()


def by_libreoffice(path, _):
    for row in ElementTree.parse(path).iter(TABLE + "table-row"):
        cells = []
        for cell in row.iter(TABLE + "table-cell"):
            repeated = int(cell.get(TABLE + "number-columns-repeated", 1))
            cells += [content(cell)] * min(repeated, COLUMNS_MAX)
        while cells and cells[-1] is None:
            cells.pop()
        if cells:
            yield cells


def content(cell):
    assert cell.get(TABLE + "formula") is None, ElementTree.tostring(cell)
    kind = cell.get(OFFICE + "value-type")
    if kind is None:
        return None
    if kind == "float":
        return float(cell.get(OFFICE + "value"))
    text = "\n".join("".join(line.itertext()) for line in cell.iter(TEXT + "p"))
    return text if kind == "string" else [kind, text]


READERS = {"csv": by_csv, "pandas": by_pandas, "fods": by_libreoffice}


def main(reader, path, expected):
    with open(expected, encoding="utf-8") as file:
        expected = [json.loads(line) for line in file]
    rows = list(READERS[reader](path, expected))
    assert len(rows) == len(expected), (len(rows), len(expected))
    for row, wanted in zip(rows, expected):
        # LibreOffice does not store the empty cells at the end of a row.
        row += [None] * (len(wanted) - len(row))
        assert row == wanted, f"read {row}, expected {wanted}"


if __name__ == "__main__":
    main(*sys.argv[1:])
