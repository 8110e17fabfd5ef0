# SPDX-License-Identifier: Apache-2.0
"""Reads the .vtu files of a run with the Python standard library alone, as an independent check.

read_vtu(path) returns {"points": ..., "cells": ..., "point_data": ..., "cell_data": ..., "time": ...};
arrays are lists of tuples (several components) or of numbers. As a program it prints that as JSON.
"""
import base64
import json
import struct
import sys
import xml.etree.ElementTree as ElementTree
import zlib

FORMATS = {"Float64": "d", "Int32": "i", "UInt8": "B"}


def decode_blocks(text):
    """Bytes of a zlib-compressed inline array with a header of UInt64 block sizes."""
    text = text.strip()
    (num_blocks,) = struct.unpack("<Q", base64.b64decode(text[:12])[:8])
    header_bytes = 8 * (3 + num_blocks)
    header_chars = (header_bytes + 2) // 3 * 4
    header = struct.unpack(f"<{3 + num_blocks}Q", base64.b64decode(text[:header_chars], validate=True))
    block_size, last_size, packed_sizes = header[1], header[2], header[3:]
    packed = base64.b64decode(text[header_chars:], validate=True)
    if len(packed) != sum(packed_sizes):
        raise ValueError(f"{len(packed)} bytes of data, {sum(packed_sizes)} announced")
    out, offset = [], 0
    for index, size in enumerate(packed_sizes):
        block = zlib.decompress(packed[offset:offset + size])
        is_last = index == num_blocks - 1
        if len(block) != (last_size if is_last and last_size else block_size):
            raise ValueError(f"block {index} has {len(block)} bytes")
        out.append(block)
        offset += size
    return b"".join(out)


def decode_array(element):
    raw = decode_blocks(element.text)
    kind = FORMATS[element.get("type")]
    values = struct.unpack(f"<{len(raw) // struct.calcsize(kind)}{kind}", raw)
    width = int(element.get("NumberOfComponents", "1"))
    if width == 1:
        return list(values)
    return [values[i:i + width] for i in range(0, len(values), width)]


def read_vtu(path):
    root = ElementTree.parse(path).getroot()
    expected = {"type": "UnstructuredGrid", "byte_order": "LittleEndian", "header_type": "UInt64",
                "compressor": "vtkZLibDataCompressor"}
    for key, value in expected.items():
        if root.get(key) != value:
            raise ValueError(f"VTKFile {key} is {root.get(key)}")
    grid = root.find("UnstructuredGrid")
    piece = grid.find("Piece")
    named = {section: {a.get("Name"): decode_array(a) for a in piece.find(section)}
             for section in ("PointData", "CellData", "Points", "Cells")}
    points, lists = named["Points"]["Points"], named["Cells"]
    num_points, num_cells = int(piece.get("NumberOfPoints")), int(piece.get("NumberOfCells"))
    for name, values in {**named["PointData"], "Points": points}.items():
        if len(values) != num_points:
            raise ValueError(f"{name}: {len(values)} values for {num_points} points")
    for name, values in {**named["CellData"], "types": lists["types"], "offsets": lists["offsets"]}.items():
        if len(values) != num_cells:
            raise ValueError(f"{name}: {len(values)} values for {num_cells} cells")
    starts = [0] + lists["offsets"][:-1]
    cells = [(kind, tuple(lists["connectivity"][begin:end]))
             for kind, begin, end in zip(lists["types"], starts, lists["offsets"])]
    if any(not 0 <= v < num_points for _, corners in cells for v in corners):
        raise ValueError("a cell names a point that is not there")
    return {"points": points, "cells": cells, "point_data": named["PointData"],
            "cell_data": named["CellData"],
            "time": float(grid.find("FieldData").find("DataArray").text)}


if __name__ == "__main__":
    json.dump(read_vtu(sys.argv[1]), sys.stdout)
