#!/usr/bin/env python3
"""Writes tests/data/water.gpkg, and water.shp and water_lines.shp with their tables, from water.geojson. Needs only
Python."""

import json
import os
import sqlite3
import struct

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "data")


def path(name):
    return os.path.join(FOLDER, name)


def features():
    """Kind, parts and river of each feature."""
    with open(path("water.geojson")) as file:
        for feature in json.load(file)["features"]:
            geometry = feature["geometry"]
            is_line = geometry["type"] == "LineString"
            parts = [geometry["coordinates"]] if is_line else geometry["coordinates"]
            yield is_line, parts, feature["properties"].get("river")


def shapefile(name, kind, rows):
    """Types 3 and 5: lines and polygons without z."""
    records = b""
    for number, (parts, _) in enumerate(rows, 1):
        vertices = [vertex for part in parts for vertex in part]
        x, y = zip(*vertices)
        content = struct.pack("<i4d2i", kind, min(x), min(y), max(x), max(y), len(parts), len(vertices))
        starts = [sum(map(len, parts[:part])) for part in range(len(parts))]
        content += struct.pack("<%di" % len(starts), *starts)
        content += b"".join(struct.pack("<2d", *vertex) for vertex in vertices)
        records += struct.pack(">2i", number, len(content) // 2) + content
    head = struct.pack(">7i", 9994, 0, 0, 0, 0, 0, (100 + len(records)) // 2) + struct.pack("<2i", 1000, kind)
    with open(path(name + ".shp"), "wb") as file:
        file.write(head + struct.pack("<8d", *[0] * 8) + records)
    fields = [(b"ID", b"N", 6), (b"RIVER", b"C", 12)]
    table = b"".join(struct.pack("<11sc4xBB14x", *field, 0) for field in fields) + b"\r"
    table = struct.pack("<B3BIHH20x", 3, 126, 1, 1, len(rows), 32 + len(table), 19) + table
    for number, (_, river) in enumerate(rows, 1):
        table += b" " + b"%6d" % number + (river or "").encode().ljust(12)
    with open(path(name + ".dbf"), "wb") as file:
        file.write(table + b"\x1a")


def wkb(is_line, parts):
    bytes_ = struct.pack("<BI", 1, 2 if is_line else 3)
    if not is_line:
        bytes_ += struct.pack("<I", len(parts))
    for part in parts:
        bytes_ += struct.pack("<I", len(part)) + b"".join(struct.pack("<2d", *vertex) for vertex in part)
    return b"GP\0\1" + struct.pack("<i", 2975) + bytes_


def geopackage(rows):
    if os.path.exists(path("water.gpkg")):
        os.remove(path("water.gpkg"))
    database = sqlite3.connect(path("water.gpkg"))
    database.executescript(
        "PRAGMA page_size = 512; PRAGMA application_id = 1196444487; PRAGMA user_version = 10400;"
        "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT"
        " NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);"
        "CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT NOT NULL, srs_id INTEGER);"
        "CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,"
        " geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL);"
        "CREATE TABLE water (fid INTEGER PRIMARY KEY, River TEXT, geom GEOMETRY, level REAL);"
        "INSERT INTO gpkg_spatial_ref_sys VALUES ('RGR92', 2975, 'EPSG', 2975, '', '');"
        "INSERT INTO gpkg_contents VALUES ('water', 'features', 2975);"
        "INSERT INTO gpkg_geometry_columns VALUES ('water', 'geom', 'GEOMETRY', 2975, 0, 0);"
    )
    for is_line, parts, river in rows:
        database.execute("INSERT INTO water (River, geom) VALUES (?, ?)", (river, wkb(is_line, parts)))
    database.commit()
    database.execute("VACUUM")
    database.close()


if __name__ == "__main__":
    all_rows = list(features())
    shapefile("water", 5, [row[1:] for row in all_rows if not row[0]])
    shapefile("water_lines", 3, [row[1:] for row in all_rows if row[0]])
    geopackage(all_rows)
